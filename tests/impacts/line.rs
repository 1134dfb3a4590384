//! Bodies on a line that hit each other, one pair at a time, in double precision.

/// The bodies from left to right.
pub(crate) struct Line {
    restitution: f64,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    masses: Vec<f64>,
    halves: Vec<f64>,
    /// The moment of the last impact of each body, and how exactly an engine has to know it, s.
    last: Vec<(f64, f64)>,
    now: f64,
    /// True from the moment on at which the order of two impacts of one body was a matter of less than that.
    is_crowded: bool,
}

/// The time that bodies need for a millimetre, s: an engine may have an impact so much sooner or later.
fn tolerance(closing: f64) -> f64 {
    1e-5 + 1e-3 / closing
}

impl Line {
    pub(crate) fn new(restitution: f64) -> Self {
        Self {
            restitution,
            positions: Vec::new(),
            velocities: Vec::new(),
            masses: Vec::new(),
            halves: Vec::new(),
            last: Vec::new(),
            now: 0.0,
            is_crowded: false,
        }
    }

    pub(crate) fn push(&mut self, position: f64, velocity: f64, mass: f64, half: f64) {
        self.positions.push(position);
        self.velocities.push(velocity);
        self.masses.push(mass);
        self.halves.push(half);
        self.last.push((f64::NEG_INFINITY, 0.0));
    }

    pub(crate) fn velocities(&self) -> &[f64] {
        &self.velocities
    }

    pub(crate) fn restitution(&self) -> f64 {
        self.restitution
    }

    pub(crate) fn fastest(&self) -> f64 {
        self.velocities.iter().fold(1e-3, |fastest, v| f64::max(fastest, v.abs()))
    }

    /// Returns true if two impacts of one body were so near to each other in time that they may come in either order.
    pub(crate) fn is_crowded(&self) -> bool {
        self.is_crowded
    }

    /// Returns true if no impact was just before, or is just after.
    pub(crate) fn is_between_impacts(&self) -> bool {
        let is_past = self.last.iter().all(|&(moment, tolerance)| self.now - moment > tolerance);
        is_past
            && (1..self.positions.len()).all(|right| {
                let closing = self.closing(right);
                self.meeting(right).is_none_or(|wait| wait > tolerance(closing))
            })
    }

    /// Moves the bodies for a duration, and counts the impacts.
    pub(crate) fn advance(&mut self, duration: f64) -> usize {
        let end = self.now + duration;
        for count in 0..1_000 {
            let next = (1..self.positions.len()).filter_map(|right| Some((self.meeting(right)?, right)));
            let next = next.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|next| self.now + next.0 < end);
            let Some((wait, right)) = next else {
                self.fly(end - self.now);
                return count;
            };
            self.fly(wait);
            self.hit(right);
        }
        // An endless sequence in no time.
        self.is_crowded = true;
        0
    }

    fn closing(&self, right: usize) -> f64 {
        self.velocities[right - 1] - self.velocities[right]
    }

    /// The time until a body meets the one on its left.
    fn meeting(&self, right: usize) -> Option<f64> {
        let closing = self.closing(right);
        let reach = self.halves[right - 1] + self.halves[right];
        let gap = self.positions[right] - self.positions[right - 1] - reach;
        (closing > 1e-12).then(|| f64::max(gap, 0.0) / closing)
    }

    fn fly(&mut self, wait: f64) {
        for (position, velocity) in self.positions.iter_mut().zip(&self.velocities) {
            *position += velocity * wait;
        }
        self.now += wait;
    }

    fn hit(&mut self, right: usize) {
        let left = right - 1;
        let [a, b] = [self.masses[left], self.masses[right]];
        let closing = self.closing(right);
        let impulse = (1.0 + self.restitution) * closing / (1.0 / a + 1.0 / b);
        self.velocities[left] -= impulse / a;
        self.velocities[right] += impulse / b;
        for body in [left, right] {
            let (moment, before) = self.last[body];
            self.is_crowded |= self.now - moment < before + tolerance(closing);
            self.last[body] = (self.now, tolerance(closing));
        }
    }
}
