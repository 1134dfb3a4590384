//! The parameters of a scene's world, and how to draw it.

use alloc::string::String;
use alloc::vec::Vec;

use super::body::own_damping;
use super::collider::contacts;
use super::error::Flaw;
use super::field::{Names, named};
use super::node::{Kind, Node, Result};
use super::object::Object;
use umbra_physics::{Damping, Error, Integrator, Quantity, Random, TimeStep, Vec2, WorldDef};

/// Reads the world's definition and refuses what no world can be; the rest is then read with a standard world.
pub(super) fn world(object: &Object<'_>) -> WorldDef {
    let standard: WorldDef = WorldDef::default();
    let (linear_damping, angular_damping) = object.or("damping", (Damping::NONE, Damping::NONE), world_damping);
    let def = WorldDef {
        time_step: object.or("time_step", standard.time_step, time_step),
        gravity: object.or("gravity", Vec2::ZERO, Node::point),
        integrator: object.or("integrator", standard.integrator, integrator),
        linear_damping,
        angular_damping,
        sleep_after: object.or("sleep_after", standard.sleep_after, sleep_after),
        contacts: object.or("contacts", standard.contacts, contacts),
    };
    let Err(error) = def.check() else { return def };
    let field = match error {
        Error::TimeStep => "time_step",
        Error::OutOfRange { quantity: Quantity::Gravity } => "gravity",
        Error::OutOfRange { quantity: Quantity::SleepAfter } => "sleep_after",
        _ => "damping",
    };
    object.at(&[field]).fault(error);
    standard
}

/// "num/den" or {num, den}, in s.
pub(super) fn time_step(node: &Node<'_>) -> Result<TimeStep> {
    let (num, den) = match node.kind() {
        Kind::Object => {
            let object = node.object()?;
            let (num, den) = (object.need("num", Node::whole), object.need("den", Node::whole));
            object.finish()?;
            (num?, den?)
        }
        Kind::Text => {
            let text = node.string()?;
            let ratio = text.split_once('/').and_then(|(n, d)| Some((n.trim().parse().ok()?, d.trim().parse().ok()?)));
            ratio
                .ok_or_else(|| node.fault(Flaw::WrongKind.of(r#"expected a ratio of whole numbers such as "1/60""#)))?
        }
        _ => return Err(node.wrong_kind(r#"a ratio such as "1/60""#)),
    };
    Ok(TimeStep::ratio(num, den))
}

pub(super) fn integrator(node: &Node<'_>) -> Result<Integrator> {
    node.choice(&Integrator::ALL.map(|integrator| (integrator.name(), integrator)))
}

/// A number of ticks, or null for never.
pub(super) fn sleep_after(node: &Node<'_>) -> Result<Option<u32>> {
    if node.kind() == Kind::Null { Ok(None) } else { node.whole().map(Some) }
}

pub(super) fn world_damping(node: &Node<'_>) -> Result<(Damping, Damping)> {
    let (linear, angular) = own_damping(node)?;
    Ok((linear.unwrap_or_default(), angular.unwrap_or_default()))
}

/// A seed, or the four words of a generator's state.
pub(super) fn random(node: &Node<'_>) -> Result<Random> {
    if node.kind() != Kind::List {
        return node.whole().map(Random::seeded);
    }
    let [a, b, c, d] = node.tuple()?.map(|word: Node<'_>| word.whole());
    let state = [a?, b?, c?, d?];
    Random::from_state(state).ok_or_else(|| node.fault("out of range: the state of a generator must not be four zeros"))
}

/// Two hexadecimal digits a byte.
pub(super) fn blob(node: &Node<'_>) -> Result<Vec<u8>> {
    let text = node.string()?;
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let byte = |pair: &[u8]| match *pair {
        [high, low] => Some((digit(high)? << 4 | digit(low)?) as u8),
        _ => None,
    };
    let bytes: Option<_> = text.as_bytes().chunks(2).map(byte).collect();
    bytes.ok_or_else(|| node.fault(Flaw::Text.of("expected bytes as two hexadecimal digits each")))
}

/// Settings for drawing a scene. They change no result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// The lower left and the upper right corner of what is shown, m; all there is without it.
    pub view: Option<[Vec2; 2]>,
    /// The bodies whose trails are drawn.
    pub trails: Trails,
    /// The number of moments between start and end at which bodies are outlined as well.
    pub exposures: u32,
}

/// The bodies whose trails are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Trails {
    /// All bodies that move.
    #[default]
    All,
    /// No body.
    None,
    /// These bodies, as indices in [`Scene::bodies`](super::Scene::bodies).
    Of(Vec<usize>),
}

/// The most moments at which bodies are outlined.
const EXPOSURES: u32 = 1000;

pub(super) fn plot(node: &Node<'_>, bodies: &Names) -> Result<Plot> {
    let object = node.object()?;
    let view = object.get("view").map(|node| {
        let [min, max] = node.tuple()?.map(|corner: Node<'_>| corner.point());
        let (min, max) = (min?, max?);
        if min.x >= max.x || min.y >= max.y {
            return Err(node.fault("expected the lower left corner, then the upper right one"));
        }
        Ok([min, max])
    });
    let trails = |node: &Node<'_>| match node.kind() {
        Kind::Text => {
            node.choice(&[("all", true), ("none", false)]).map(|all| if all { Trails::All } else { Trails::None })
        }
        _ => {
            let mut named_here = Vec::new();
            node.each(|node| named(&node, bodies, "body").map(|index| named_here.push(index)))?;
            Ok(Trails::Of(named_here))
        }
    };
    let plot = Plot {
        view: view.and_then(Result::ok),
        trails: object.or("trails", Trails::All, trails),
        exposures: object.or("exposures", 0, Node::whole),
    };
    object.finish()?;
    if plot.exposures > EXPOSURES {
        return Err(object
            .at(&["exposures"])
            .fault(Flaw::OutOfRange.of(format_args!("out of range: at most {EXPOSURES}"))));
    }
    Ok(plot)
}

/// A text that may be left out.
pub(super) fn words(object: &Object<'_>, name: &'static str) -> String {
    object.or(name, String::new(), Node::string)
}
