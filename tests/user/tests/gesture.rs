use std::sync::LazyLock;

use undulate::testing::proptest::prelude::*;
use undulate::testing::{Seed, fails_rarely, keeps_clear, keeps_limits, tracks_within, waves_of};
use undulate::*;

static LAMP: LazyLock<Robot> =
    LazyLock::new(|| Robot::from_urdf(include_str!("lamp.urdf")).unwrap());
static NOD: LazyLock<FourierMovementPrimitive> =
    LazyLock::new(|| FourierMovementPrimitive::from_json(include_str!("nod.json")).unwrap());

proptest! {
    /// Within the robot's limits, and proven 1 cm clear of itself.
    #[test]
    fn nods_are_possible(nod in waves_of(&NOD)) {
        let collision = CollisionModel::new(&LAMP, &CollisionOptions::default())?;
        keeps_limits(&LAMP, nod.wave())?;
        keeps_clear(&collision, nod.wave(), 0.01)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]
    #[test]
    fn motors_keep_up(nod in waves_of(&NOD)) {
        let simulation = Simulation::new(&LAMP, SimulationOptions::default())?;
        tracks_within(&simulation, nod.wave(), 0.01)?;
    }
}

/// Fewer than one nod in a hundred swings the arm beyond 1 rad, with 99 % confidence.
#[test]
fn few_nods_are_deep() {
    let is_modest = |nod: &Wave| {
        let neck = nod.range(nod.joints().index("neck")?, Derivative::Position);
        match neck.upper < 1.0 {
            true => Ok(()),
            false => Err(Error::new(
                ErrorKind::Infeasible,
                format!("the neck at {:.2} rad", neck.upper),
            )),
        }
    };
    fails_rarely(&NOD, 0.01, 0.99, 1000, Seed(1), is_modest).unwrap();
}
