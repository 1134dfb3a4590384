//! Shapes.

use std::mem::MaybeUninit;

use umbra_physics::{Error, Fx, Part, Shape, Vec2};

use crate::memory::{given, slice};
use crate::number::{UmbraFx, UmbraVec2};
use crate::status::{Result, UmbraStatus, guard};

/// A shape, for any number of bodies: they keep what they need of it, so that it can be freed.
pub struct UmbraShape {
    pub(crate) shape: Shape,
}

impl UmbraShape {
    pub(crate) fn boxed(shape: Shape) -> Option<Box<Self>> {
        Some(Box::new(Self { shape }))
    }
}

/// A part of a compound.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraPart {
    /// Position of the part's centre of mass, m.
    pub position: UmbraVec2,
    /// Angle of the part, rad.
    pub angle: UmbraFx,
    /// Density relative to the other parts, above 0.
    pub density: UmbraFx,
    /// Shape of the part; it must not be a compound.
    pub shape: *const UmbraShape,
}

type Place<'a> = Option<&'a mut MaybeUninit<Option<Box<UmbraShape>>>>;

fn make(place: Place<'_>, shape: impl FnOnce() -> Result<Shape>) -> UmbraStatus {
    guard(|| {
        let place = given(place)?;
        place.write(UmbraShape::boxed(shape()?));
        Ok(())
    })
}

/// Copies vectors.
///
/// # Safety
/// As [`slice`].
unsafe fn vectors(list: *const UmbraVec2, count: usize) -> Result<Vec<Vec2>> {
    // SAFETY: as the caller promises.
    let list = unsafe { slice(list, count) }?;
    Ok(list.iter().map(|&vector| vector.into()).collect())
}

/// Makes a shape of a list of points.
///
/// # Safety
/// As [`slice`].
unsafe fn make_of_points(
    points: *const UmbraVec2,
    count: usize,
    place: Place<'_>,
    shape: fn(&[Vec2]) -> std::result::Result<Shape, Error>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    make(place, || Ok(shape(&unsafe { vectors(points, count) }?)?))
}

/// A disc of a radius of 2^-7 to 2^12 m.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_circle(
    radius: UmbraFx,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || Ok(Shape::circle(Fx::from_bits(radius))?))
}

/// A rectangle about its centre, m: sides from 2^-7 to 2^12 m.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_rectangle(
    width: UmbraFx,
    height: UmbraFx,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || Ok(Shape::rectangle(Fx::from_bits(width), Fx::from_bits(height))?))
}

/// A capsule along x; its length is between the centres of its half discs, and its radius from 2^-7 to 2^12 m.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_capsule(
    length: UmbraFx,
    radius: UmbraFx,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || Ok(Shape::capsule(Fx::from_bits(length), Fx::from_bits(radius))?))
}

/// A thin rod between two points, m.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_segment(
    a: Option<&UmbraVec2>,
    b: Option<&UmbraVec2>,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || Ok(Shape::segment((*given(a)?).into(), (*given(b)?).into())?))
}

/// A convex polygon of 3 to 64 corners, in either order, m. It is re-centred at its centre of mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_polygon(
    corners: *const UmbraVec2,
    count: usize,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { make_of_points(corners, count, shape, Shape::polygon) }
}

/// The convex hull of up to 65,536 points, a polygon of 3 to 64 corners, m: points in it and within its sides are no corners. It is re-centred at
/// its centre of mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_hull(
    points: *const UmbraVec2,
    count: usize,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { make_of_points(points, count, shape, Shape::hull) }
}

/// A polygon of 3 to 1,024 corners that may be concave, in either order, m: a compound of up to 256 convex polygons, or one polygon if it is
/// convex. A polygon that crosses or touches itself is refused with `UMBRA_ERROR_CHAIN_CROSSES`. It is re-centred at its centre of mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_concave_polygon(
    corners: *const UmbraVec2,
    count: usize,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { make_of_points(corners, count, shape, Shape::concave_polygon) }
}

/// A convex polygon of 3 to 64 corners, in either order, and all points within the radius of it, m. It is re-centred at its centre of
/// mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_rounded_polygon(
    corners: *const UmbraVec2,
    count: usize,
    radius: UmbraFx,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || {
        // SAFETY: as the caller promises.
        let corners = unsafe { vectors(corners, count) }?;
        Ok(Shape::rounded_polygon(&corners, Fx::from_bits(radius))?)
    })
}

/// 1 to 256 shapes as one. It is re-centred at its centre of mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_compound(
    parts: *const UmbraPart,
    count: usize,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || {
        // SAFETY: as the caller promises.
        let parts = unsafe { slice(parts, count) }?;
        let parts = parts.iter().map(|&UmbraPart { position, angle, density, shape }| {
            // SAFETY: the caller promises that it is null or a shape that was not freed.
            let shape = given(unsafe { shape.as_ref() })?.shape.clone();
            let (angle, density) = (Fx::from_bits(angle), Fx::from_bits(density));
            Ok(Part { shape, position: position.into(), angle, density })
        });
        Ok(Shape::compound(&parts.collect::<Result<Vec<Part>>>()?)?)
    })
}

/// A chain of segments through 2 to 65,536 points, and back to the first one if `closed` is not 0: a surface for static and kinematic
/// bodies that touches what is on its right on the way through the points, m. It is not re-centred.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_shape_chain(
    points: *const UmbraVec2,
    count: usize,
    closed: u32,
    shape: Option<&mut MaybeUninit<Option<Box<UmbraShape>>>>,
) -> UmbraStatus {
    make(shape, || {
        // SAFETY: as the caller promises.
        let points = unsafe { vectors(points, count) }?;
        Ok(Shape::chain(&points, closed != 0)?)
    })
}

/// Frees a shape. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_free(shape: Option<Box<UmbraShape>>) {
    drop(shape);
}
