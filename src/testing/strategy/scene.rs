//! Scenes.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;
use crate::collision::Scene;

/// Coordinates of what stands about a robot reach as far \[m\].
const ROOM: f64 = 2.0;

/// Scenes as TOML, of so many objects, called `object_0` and so on, within 2 m of the origin in x, y and z: half-spaces whose planes are 0.5 to 2 m away and face
/// the origin, spheres, cylinders, capsules and boxes of 2 cm to 0.5 m, turned anyhow. They shrink to fewer objects, to half-spaces and spheres, and to
/// objects at the origin.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::Scene;
/// use undulate::testing::scene_texts;
///
/// proptest!(|(text in scene_texts(0..=5))| {
///     prop_assert!(Scene::from_toml(&text).is_ok());
/// });
/// ```
///
/// # Panics
/// When `objects` is an empty range.
#[track_caller]
pub fn scene_texts(objects: RangeInclusive<usize>) -> impl Strategy<Value = String> {
    require_counts("objects", &objects, 0);
    let place = || prop::array::uniform3(-ROOM..ROOM);
    let turn = || prop::array::uniform3(-3.0..3.0f64);
    let size = || 0.02..0.5f64;
    let object = prop_oneof![
        (place(), 0.5..ROOM).prop_map(|(normal, offset)| {
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            // A plane without a direction is a floor.
            let normal = if length < 0.1 { [0.0, 0.0, 1.0] } else { normal };
            format!("half_space = {{ normal = {normal:?}, offset = {:?} }}", -offset)
        }),
        (place(), size()).prop_map(|(at, radius)| {
            format!("sphere = {{ radius = {radius:?} }}\nposition = {at:?}")
        }),
        (place(), turn(), size(), size()).prop_map(|(at, rpy, radius, length)| {
            format!(
                "cylinder = {{ radius = {radius:?}, length = {length:?} }}\nposition = {at:?}\nrpy = {rpy:?}"
            )
        }),
        (place(), turn(), size(), size()).prop_map(|(at, rpy, radius, length)| {
            format!(
                "capsule = {{ radius = {radius:?}, length = {length:?} }}\nposition = {at:?}\nrpy = {rpy:?}"
            )
        }),
        (place(), turn(), prop::array::uniform3(size())).prop_map(|(at, rpy, size)| {
            format!("box = {{ size = {size:?} }}\nposition = {at:?}\nrpy = {rpy:?}")
        }),
    ];
    vec(object, objects).prop_map(|objects| {
        let mut text = String::new();
        for (i, object) in objects.iter().enumerate() {
            let _ = writeln!(text, "[[object]]\nname = \"object_{i}\"\n{object}\n");
        }
        text
    })
}

/// The scenes of [`scene_texts`].
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::scenes;
///
/// proptest!(|(scene in scenes(1..=4))| {
///     prop_assert_eq!(&scene.objects()[0].name, "object_0");
/// });
/// ```
///
/// # Panics
/// When `objects` is an empty range.
#[track_caller]
pub fn scenes(objects: RangeInclusive<usize>) -> impl Strategy<Value = Scene> {
    scene_texts(objects).prop_map(|text| Scene::from_toml(&text).expect("built to be a scene"))
}
