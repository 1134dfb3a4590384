//! Events of contacts, sensors and joints, from the report of a step.

use umbra_physics::{BodyId, ColliderPair, StepReport};

use super::events::{Events, What};
use super::words::short;

/// Tells the encounters of a step. `life` has the number under which the page knows a body, also one that went in this tick.
pub(super) fn tell(report: &StepReport<'_>, events: &mut Events, life: impl Fn(BodyId) -> Option<usize>) {
    let tick = report.tick;
    let lives = |bodies: [BodyId; 2]| bodies.into_iter().filter_map(&life).collect::<Vec<_>>();
    for (pairs, what) in [
        (report.contacts_ended, What::Parted),
        (report.contacts_began, What::Touched),
        (report.sensors_left, What::Left),
        (report.sensors_entered, What::Entered),
    ] {
        for ColliderPair { bodies: [first, second], .. } in pairs {
            // Of a sensor and its visitor, which is the second one, the visitor is named first.
            let is_sensor = matches!(what, What::Left | What::Entered);
            let bodies = if is_sensor { [*second, *first] } else { [*first, *second] };
            events.add(tick, what, lives(bodies), String::new());
        }
    }
    for hit in report.hits {
        let text = format!("at {} m/s, {} N·s", short(hit.approach_speed), short(hit.normal_impulse));
        events.add(tick, What::Hit, lives(hit.pair.bodies), text);
    }
    for broke in report.joints_broke {
        let bodies = broke.bodies.into_iter().flatten().filter_map(&life).collect();
        events.add(tick, What::Broke, bodies, broke.joint.to_string());
    }
}
