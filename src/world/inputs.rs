//! The inputs of a tick in a canonical order.

use alloc::collections::{BTreeMap, btree_map};
use alloc::vec::Vec;

use super::{Command, Created, World};
use crate::codec::{self, Malformed, Read as _, Reader, codec_struct};
use crate::error::Error;
use crate::fx::Fx;
use crate::scalar::Scalar;

/// A command of a player.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        deny_unknown_fields,
        bound(
            serialize = "S: serde::Serialize, S::Factor: serde::Serialize",
            deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>"
        )
    )
)]
pub struct Input<S: Scalar = Fx> {
    /// The player. Inputs are carried out in ascending player order.
    pub player: u32,
    /// The place among the inputs of this player in this tick.
    pub sequence: u32,
    /// The command.
    pub command: Command<S>,
}

codec_struct!(Input { player, sequence, command });

impl<S: Scalar> Input<S> {
    /// The smallest number of bytes: a player, a sequence, and the shortest command.
    pub(crate) const LEAST_BYTES: usize = 8 + Command::LEAST_BYTES;

    fn place(&self) -> (u32, u32) {
        (self.player, self.sequence)
    }
}

/// The inputs of one tick, ordered by player and then by sequence, regardless of the order in which they arrived. Peers with
/// the same inputs carry them out in the same order.
///
/// ```
/// use umbra_physics::{BodyDef, Command, Input, Inputs, Created, World, WorldDef};
///
/// let mut inputs = Inputs::new();
/// let command = Command::AddBody(BodyDef { user_data: 7, ..BodyDef::dynamic() });
/// inputs.insert(Input { player: 1, sequence: 0, command })?;
/// inputs.insert(Input { player: 0, sequence: 0, command: Command::AddBody(BodyDef::dynamic()) })?;
///
/// let mut world = World::new(WorldDef::default())?;
/// for outcome in world.carry_out(&inputs) {
///     if let (1, Ok(Created::Body(body))) = (outcome.player, outcome.result) {
///         assert_eq!(world.body(body)?.user_data(), 7);
///         assert_eq!(body.parts(), (1, 0)); // the second body of the world
///     }
/// }
/// # Ok::<(), umbra_physics::Error>(())
/// ```
///
/// ```
/// use umbra_physics::{Command, Inputs, InputsIter, Random};
///
/// let mut inputs = Inputs::new();
/// for player in [2, 0, 1] {
///     assert!(inputs.replace(player, [Command::SetRandom(Random::seeded(player.into()))]));
/// }
/// let in_order: InputsIter<'_> = inputs.iter();
/// assert_eq!(in_order.map(|input| input.player).collect::<Vec<_>>(), [0, 1, 2]);
/// inputs.clear(); // keeps the memory for another tick
/// assert_eq!((inputs.is_empty(), inputs.len()), (true, 0));
/// ```
#[derive(Debug, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize),
    serde(
        try_from = "Vec<Input<S>>",
        bound(deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>")
    )
)]
pub struct Inputs<S: Scalar = Fx> {
    /// Inputs in order.
    rows: Vec<Input<S>>,
    /// Inputs that arrived after an input with a later place: inserted into the rows, each would move all rows behind it.
    late: BTreeMap<(u32, u32), Input<S>>,
}

clone_by_field!((clone_inputs, clone_inputs_from) Inputs { rows, late });

impl<S: Scalar> PartialEq for Inputs<S> {
    /// Compares the inputs, regardless of the order in which they arrived.
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other)
    }
}

impl Inputs {
    /// No inputs. [`Inputs::default`] has none either, of any type of number.
    #[must_use]
    pub const fn new() -> Self {
        Self { rows: Vec::new(), late: BTreeMap::new() }
    }
}

impl<S: Scalar> Inputs<S> {
    /// Adds an input in its place.
    ///
    /// *Cost* a search in a sorted list; for inputs that arrive in order, constant.
    ///
    /// # Errors
    /// [`Error::DuplicateInput`] if there is one of the same player and sequence, which is kept.
    pub fn insert(&mut self, input: Input<S>) -> Result<(), Error> {
        let place = input.place();
        if self.rows.last().is_none_or(|last| last.place() < place) {
            self.rows.push(input);
            return Ok(());
        }
        let Input { player, sequence, .. } = input;
        if self.rows.binary_search_by_key(&place, Input::place).is_ok() || self.late.contains_key(&place) {
            return Err(Error::DuplicateInput { player, sequence });
        }
        self.late.insert(place, input);
        Ok(())
    }

    /// Replaces all inputs of a player by these commands, with sequences from 0. Returns true if they were other ones.
    ///
    /// *Cost* in proportion to the inputs of the tick, and to the commands.
    pub fn replace(&mut self, player: u32, commands: impl IntoIterator<Item = Command<S>>) -> bool {
        S::replace(self, player, &mut commands.into_iter())
    }

    pub(crate) fn replace_inner(&mut self, player: u32, commands: &mut dyn Iterator<Item = Command<S>>) -> bool {
        self.merge();
        let first = self.rows.partition_point(|input| input.player < player);
        let end = first + self.rows[first..].partition_point(|input| input.player == player);
        let mut inputs = (0..).zip(commands).map(|(sequence, command)| Input { player, sequence, command });
        let mut changed = false;
        let mut next = first;
        while next < end {
            let Some(input) = inputs.next() else { break };
            changed |= self.rows[next] != input;
            self.rows[next] = input;
            next += 1;
        }
        changed |= next < end;
        let inserted = inputs.inspect(|_| changed = true);
        self.rows.splice(next..end, inserted);
        changed
    }

    /// Merges the late inputs into the rows.
    fn merge(&mut self) {
        if !self.late.is_empty() {
            let mut all = Vec::with_capacity(self.len());
            let mut late = core::mem::take(&mut self.late).into_values().peekable();
            for row in self.rows.drain(..) {
                while let Some(input) = late.next_if(|input| input.place() < row.place()) {
                    all.push(input);
                }
                all.push(row);
            }
            self.rows = all;
        }
    }

    /// Iterates over the inputs in order.
    #[must_use]
    pub fn iter(&self) -> InputsIter<'_, S> {
        InputsIter { rows: self.rows.iter(), late: self.late.values() }
    }

    /// The number of inputs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() + self.late.len()
    }

    /// True if there are no inputs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all inputs, and keeps the memory.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.late.clear();
    }
}

impl Inputs {
    /// Encodes the inputs in their order: the same bytes on every machine, as `docs/formats.md` describes them.
    ///
    /// ```
    /// use umbra_physics::{BodyId, Command, Inputs, vec2};
    ///
    /// let mut inputs = Inputs::new();
    /// inputs.replace(1, [Command::SetVelocity { body: BodyId::from_parts(3, 0), velocity: vec2(1, 0) }]);
    /// let packet = inputs.to_bytes();
    /// assert_eq!(packet.len(), 4 + 8 + 25);
    /// assert_eq!(Inputs::from_bytes(&packet), Ok(inputs));
    /// assert!(Inputs::from_bytes(&packet[..20]).is_err());
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        codec::list(&mut bytes, self.iter());
        bytes
    }

    /// Decodes inputs. The bytes need not be trusted: they are refused, or are what [`to_bytes`](Self::to_bytes) writes for these
    /// inputs. Decoding takes at most 40 bytes of memory for each byte read, and 64 KiB. A limit on the bytes is a limit on the
    /// commands: each takes nine bytes or more.
    ///
    /// # Errors
    /// [`Malformed`] with the place of the first byte that no inputs have there: inputs out of order and inputs given twice are
    /// refused as well.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        let count = reader.count(Input::<Fx>::LEAST_BYTES)?;
        // 40 bytes of memory a byte: a list that grew as it is read would take more.
        const { assert!(size_of::<Input>() <= 40 * Input::<Fx>::LEAST_BYTES) };
        let mut rows: Vec<Input> = Vec::with_capacity(count);
        for _ in 0..count {
            let malformed = reader.malformed("inputs by player and sequence");
            let input = Input::read(&mut reader)?;
            if rows.last().is_some_and(|last| last.place() >= input.place()) {
                return Err(malformed);
            }
            rows.push(input);
        }
        reader.end()?;
        Ok(Self { rows, late: BTreeMap::new() })
    }
}

/// An iterator over [`Inputs`] in order.
#[derive(Clone, Debug)]
pub struct InputsIter<'a, S: Scalar = Fx> {
    rows: core::slice::Iter<'a, Input<S>>,
    late: btree_map::Values<'a, (u32, u32), Input<S>>,
}

impl<'a, S: Scalar> Iterator for InputsIter<'a, S> {
    type Item = &'a Input<S>;

    fn next(&mut self) -> Option<&'a Input<S>> {
        let Some(late) = self.late.clone().next() else { return self.rows.next() };
        match self.rows.as_slice().first() {
            Some(row) if row.place() < late.place() => self.rows.next(),
            _ => self.late.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let len = self.rows.len() + self.late.len();
        (len, Some(len))
    }
}

impl<S: Scalar> ExactSizeIterator for InputsIter<'_, S> {}

impl<S: Scalar> TryFrom<Vec<Input<S>>> for Inputs<S> {
    type Error = Error;

    /// Takes inputs in any order.
    ///
    /// # Errors
    /// [`Error::DuplicateInput`] for the first two of the same player and sequence.
    fn try_from(mut rows: Vec<Input<S>>) -> Result<Self, Error> {
        rows.sort_by_key(Input::place);
        match rows.windows(2).find(|pair| pair[0].place() == pair[1].place()) {
            Some(pair) => Err(Error::DuplicateInput { player: pair[0].player, sequence: pair[0].sequence }),
            None => Ok(Self { rows, late: BTreeMap::new() }),
        }
    }
}

#[cfg(feature = "serde")]
impl<S: Scalar + serde::Serialize> serde::Serialize for Inputs<S>
where
    S::Factor: serde::Serialize,
{
    fn serialize<W: serde::Serializer>(&self, serializer: W) -> Result<W::Ok, W::Error> {
        serializer.collect_seq(self)
    }
}

impl<'a, S: Scalar> IntoIterator for &'a Inputs<S> {
    type Item = &'a Input<S>;
    type IntoIter = InputsIter<'a, S>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// The result of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct InputResult {
    /// The player.
    pub player: u32,
    /// The place among the inputs of this player.
    pub sequence: u32,
    /// The created handle, or the error with which the command was refused: then it changed nothing.
    pub result: Result<Created, Error>,
}

impl<S: Scalar> World<S> {
    /// Carries out the inputs of a tick in order, and returns their results in the same order. An input that is refused changes
    /// nothing and does not stop the others: it is refused for every peer.
    pub fn carry_out(&mut self, inputs: &Inputs<S>) -> Vec<InputResult> {
        let mut outcomes = Vec::with_capacity(inputs.len());
        self.carry_out_into(inputs, &mut outcomes);
        outcomes
    }

    /// [`carry_out`](Self::carry_out) into existing memory.
    pub(crate) fn carry_out_into(&mut self, inputs: &Inputs<S>, outcomes: &mut Vec<InputResult>) {
        S::carry_out(self, inputs, outcomes);
    }

    pub(crate) fn carry_out_inner(&mut self, inputs: &Inputs<S>, outcomes: &mut Vec<InputResult>) {
        outcomes.clear();
        outcomes.extend(inputs.iter().map(|input| self.carry_out_one(input)));
    }

    /// Carries out one input.
    pub(crate) fn carry_out_one(&mut self, input: &Input<S>) -> InputResult {
        let result = self.execute(&input.command);
        InputResult { player: input.player, sequence: input.sequence, result }
    }
}
