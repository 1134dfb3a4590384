//! The motion of a body, tick by tick, in few bytes and to the last bit.
//!
//! A free body's values are near the parabola through the three before them, so that what is stored is how far they are
//! off it: a byte of bits that say which are off at all, then a varint for each of these. Where none is off, a zero and
//! a varint for how many more samples follow like this. `data.js` reads the same.

/// The values of a body that are shown, as bits of `Fx`: x, y, angle, the velocity's x and y, angular velocity.
pub(super) type Sample = [i64; 6];

#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    bytes: Vec<u8>,
    count: u64,
    /// Samples on their parabolas that `bytes` does not say yet.
    unsaid: u64,
    past: Past,
}

/// The three samples before, the latest first.
#[derive(Clone, Copy, Debug, Default)]
struct Past([Sample; 3]);

impl Past {
    /// The value on the parabola. It wraps: any residual leads back.
    fn predicted(&self, i: usize) -> i64 {
        let [a, b, c] = self.0;
        a[i].wrapping_sub(b[i]).wrapping_mul(3).wrapping_add(c[i])
    }

    /// The first sample stands for the two before it too.
    fn push(&mut self, sample: Sample, is_first: bool) {
        let [a, b, _] = self.0;
        self.0 = if is_first { [sample; 3] } else { [sample, a, b] };
    }
}

impl Track {
    pub(super) fn push(&mut self, sample: Sample) {
        let off: [i64; 6] = std::array::from_fn(|i| sample[i].wrapping_sub(self.past.predicted(i)));
        let which = (0..6).filter(|&i| off[i] != 0).fold(0, |which, i| which | 1 << i);
        if which == 0 {
            self.unsaid += 1;
        } else {
            self.say();
            self.bytes.push(which);
            off.into_iter().filter(|&off| off != 0).for_each(|off| write(&mut self.bytes, zigzag(off)));
        }
        self.past.push(sample, self.count == 0);
        self.count += 1;
    }

    fn say(&mut self) {
        if let Some(more) = self.unsaid.checked_sub(1) {
            self.bytes.push(0);
            write(&mut self.bytes, more);
            self.unsaid = 0;
        }
    }

    /// The number of samples.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// The number of bytes, but for a few that are not said yet.
    pub(super) fn size(&self) -> usize {
        self.bytes.len()
    }

    /// The whole track.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.say();
        self.bytes
    }

    /// The samples again.
    pub(super) fn samples(&self) -> Samples<'_> {
        Samples { bytes: &self.bytes, left: self.count, run: 0, past: Past::default(), is_first: true }
    }
}

pub(super) struct Samples<'a> {
    bytes: &'a [u8],
    left: u64,
    /// Samples on their parabolas that are still to come of a run of them.
    run: u64,
    past: Past,
    is_first: bool,
}

impl Iterator for Samples<'_> {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        self.left = self.left.checked_sub(1)?;
        let mut which = 0;
        if self.run > 0 {
            self.run -= 1;
        } else if let Some((&first, rest)) = self.bytes.split_first() {
            (which, self.bytes) = (first, rest);
            if which == 0 {
                self.run = read(&mut self.bytes);
            }
        }
        let sample = std::array::from_fn(|i| {
            let off = if which >> i & 1 == 1 { unzigzag(read(&mut self.bytes)) } else { 0 };
            self.past.predicted(i).wrapping_add(off)
        });
        self.past.push(sample, self.is_first);
        self.is_first = false;
        Some(sample)
    }
}

/// Small numbers of either sign as small numbers.
fn zigzag(value: i64) -> u64 {
    (value << 1 ^ value >> 63) as u64
}

fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

/// Seven bits a byte, the lowest first; the eighth says that more follow.
fn write(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn read(bytes: &mut &[u8]) -> u64 {
    let (mut value, mut shift) = (0, 0);
    while let Some((&byte, rest)) = bytes.split_first() {
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        shift += 7;
        if byte < 0x80 || shift > 63 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(samples: &[Sample]) -> Track {
        let mut track = Track::default();
        samples.iter().for_each(|&sample| track.push(sample));
        track
    }

    #[test]
    fn samples_come_back_to_the_last_bit() {
        let edges = [0, 1, -1, i64::MAX, i64::MIN, 1 << 32, -(1 << 31), 0x0123_4567_89ab_cdef];
        let jumps: Vec<Sample> = (0..64).map(|n| std::array::from_fn(|i| edges[(n * (i + 3) + n / 8) % 8])).collect();
        let still = [[0; 6]; 9];
        let rests: Vec<Sample> = (0..100i64).map(|n| [n / 40, 7, -(n / 30), 0, 0, i64::MIN]).collect();
        for samples in [&jumps[..], &still, &rests, &[]] {
            let mut track = track(samples);
            assert_eq!(track.samples().collect::<Vec<_>>(), samples, "while some are unsaid");
            track.say();
            assert_eq!(track.samples().collect::<Vec<_>>(), samples);
        }
    }

    #[test]
    fn a_body_at_rest_or_in_free_flight_takes_a_few_bytes_in_all() {
        let rest = [[5 << 32, -3, 1, 0, 0, 0]; 10_000];
        assert!(track(&rest).finish().len() < 20);
        let flight: Vec<Sample> =
            (0..10_000i64).map(|n| [n << 26, (n << 30) - n * n * 99, 0, 1 << 32, -n, 0]).collect();
        assert!(track(&flight).finish().len() < 60);
    }
}
