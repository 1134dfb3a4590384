//! The energy that the springs of a joint hold, and the masses that they meet.
//!
//! A row with the effective mass m and a spring of the frequency f has the stiffness k = m·(2πf)². The spring holds the work that it takes to
//! stretch it by x with a force of k·x, up to its largest force F:
//!
//! ```text
//! ½·k·x²                        up to x = F/k
//! ½·F²/k + F·(x − F/k)          beyond it: F·(x − ½·F/k)
//! ```

use super::{Axis, AxisSpring, Flight, Joint, JointKind, length_of};
use crate::scalar::FxFactor;

/// The spring of a row, and its stretch in 2^-32 m or rad: within ±2^62, as positions of joints are.
fn stretched(law: Option<Axis>) -> Option<(AxisSpring, i64)> {
    let law = law?;
    let spring = law.spring?;
    let stretch = law.position.saturating_sub(spring.rest).to_bits();
    Some((spring, stretch.clamp(-(1 << 62), 1 << 62)))
}

/// The energy of a spring at a stretch in 2^-32 m or rad, for the effective mass of its row, kg or kg·m²: in J.
fn spring_energy(spring: &AxisSpring, stretch: i64, mass: FxFactor) -> FxFactor {
    let half = FxFactor::from_ratio(1, 2);
    let stretch = FxFactor::new(stretch.unsigned_abs().into(), 32);
    let rate = FxFactor::from_scalar(spring.frequency).times(FxFactor::PI).times(2.into());
    let stiffness = mass.times(rate).times(rate);
    let (pull, strongest) = (stiffness.times(stretch), FxFactor::from_scalar(spring.max_force));
    if pull <= strongest {
        return half.times(pull).times(stretch);
    }
    // The pull is not zero, so the stiffness is none.
    strongest.times(stretch.minus(half.times(strongest.over(stiffness))))
}

impl Joint {
    /// The energies of the springs along its axes or its line, and around, J. Rows without an effective mass have none, as no spring acts on them.
    pub(crate) fn spring_energies(&self, flights: &[Flight]) -> [FxFactor; 2] {
        let bodies = self.bodies.map(|body| &flights[body as usize]);
        let along = match self.slides.map(stretched) {
            // The spring of a planar joint pulls to a point.
            [Some((spring, along)), Some((_, across))] => Some((spring, length_of(along, across))),
            [along, across] => along.or(across),
        };
        let along = along.and_then(|(spring, stretch)| {
            let mass = self.effective_mass(bodies, self.offset(flights))?;
            Some(spring_energy(&spring, stretch, mass))
        });
        let around = stretched(self.axis).and_then(|(spring, stretch)| {
            let inertia = self.effective_inertia(bodies)?;
            Some(spring_energy(&spring, stretch, inertia))
        });
        [along, around].map(Option::unwrap_or_default)
    }

    /// The effective mass of the row that a spring acts on: of the angle, kg·m², of a joint that holds its points together and of gears, else of the
    /// way along the axis or the line, kg. `None` if nothing can move, or if the line has no direction.
    pub(crate) fn spring_mass(&self, flights: &[Flight]) -> Option<FxFactor> {
        let bodies = self.bodies.map(|body| &flights[body as usize]);
        match self.kind {
            JointKind::Revolute | JointKind::Gear { .. } => self.effective_inertia(bodies),
            _ => self.effective_mass(bodies, self.offset(flights)),
        }
    }
}
