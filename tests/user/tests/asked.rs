//! Nods as they are asked for, beside a desk and a wall; and one that must not pass.

use std::sync::LazyLock;

use undulate::rand::distr::Distribution;
use undulate::testing::proptest::prelude::*;
use undulate::testing::{Family, gaussian, keeps_clear, keeps_limits, seeds};
use undulate::*;

static LAMP: LazyLock<Robot> =
    LazyLock::new(|| Robot::from_urdf(include_str!("lamp.urdf")).unwrap());
static NOD: LazyLock<FourierMovementPrimitive> =
    LazyLock::new(|| FourierMovementPrimitive::from_json(include_str!("nod.json")).unwrap());

const ROOM: &str = r#"
    [[object]]
    name = "desk"
    half_space = { normal = [0, 0, 1], offset = 0 }
    [[object]]
    name = "wall"
    half_space = { normal = [-1, 0, 0], offset = -0.6 }"#;

const FAMILY: Family = Family::new(1e-6, 1);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn postures_are_met_and_leave_room(neck in 0.35..0.55f64, seed in seeds()) {
        let options = CollisionOptions { scene: Scene::from_toml(ROOM)?, ..Default::default() };
        let collision = CollisionModel::new(&LAMP, &options)?;
        let asked = NOD.condition(&[Observation::offset("neck", neck)])?;
        let nod = asked.sample(&mut seed.rng());
        prop_assert!((nod.offsets()[nod.joints().index("neck")?] - neck).abs() < 1e-9);
        keeps_clear(&collision, &nod, 0.03)?;
    }

    #[test]
    fn draws_are_as_they_are_asked_for(neck in 0.35..0.55f64, seed in seeds()) {
        let asked = NOD.condition(&[Observation::offset("neck", neck)])?;
        let law = asked.gaussian();
        let draws: Vec<_> = (0..500).map(|k| law.sample(&mut seed.stream(k))).collect();
        let config = ProptestConfig::with_cases(32);
        gaussian(&draws, law, FAMILY.case_of(&config)).map_err(|alarm| alarm.of(seed))?;
    }
}

#[test]
fn a_hasty_nod_is_refused_and_says_why() {
    let hasty = NOD.mean_wave().slowed(0.1).unwrap();
    let why = keeps_limits(&LAMP, &hasty).unwrap_err().to_string();
    assert!(why.contains("velocity-limit: neck reaches"), "{why}");
}
