//! Limits and losses of a joint, as its file gives them.

use urdf_rs::JointType;

use super::JointProperties;
use crate::fourier::Interval;

/// What is known of `joint`. Limits of speed and effort that are 0 were not given, those of a continuous joint do not
/// hold, and the soft limits of a safety controller hold like any others: it would alter what lies beyond.
pub(super) fn properties(joint: &urdf_rs::Joint, notes: &mut Vec<String>) -> JointProperties {
    let name = &joint.name;
    let limit = &joint.limit;
    let mut given = |what: &str, value: f64| {
        if value > 0.0 {
            Some(value)
        } else {
            notes.push(format!("joint `{name}`: no {what} limit is given"));
            None
        }
    };
    let velocity = given("velocity", limit.velocity);
    let effort = given("effort", limit.effort);
    let hard = Interval {
        lower: limit.lower,
        upper: limit.upper,
    };
    let position = match joint.joint_type {
        JointType::Continuous => {
            if hard.lower != 0.0 || hard.upper != 0.0 {
                notes.push(format!(
                    "joint `{name}`: it is continuous, so its position limits {} and {} do not hold",
                    hard.lower, hard.upper
                ));
            }
            None
        }
        _ => Some(softened(joint, hard, notes)),
    };
    if position.is_some_and(|p| p.lower == 0.0 && p.upper == 0.0) {
        notes.push(format!(
            "joint `{name}`: its position limits are 0 and 0, so it may not move; give lower and upper, or make it continuous"
        ));
    }
    let dynamics = joint.dynamics.clone().unwrap_or_default();
    JointProperties {
        position,
        velocity,
        effort,
        damping: dynamics.damping,
        friction: dynamics.friction,
    }
}

/// The range within both the limits and the soft limits, where these are an interval that meets the limits'.
fn softened(joint: &urdf_rs::Joint, hard: Interval, notes: &mut Vec<String>) -> Interval {
    let Some(safety) = &joint.safety_controller else {
        return hard;
    };
    let (low, high) = (safety.soft_lower_limit, safety.soft_upper_limit);
    let both = Interval {
        lower: hard.lower.max(low),
        upper: hard.upper.min(high),
    };
    let name = &joint.name;
    if low >= high || both.lower > both.upper {
        // 0 and 0 is what tools write that have none.
        if low != 0.0 || high != 0.0 {
            notes.push(format!(
                "joint `{name}`: the soft limits {low} and {high} of its safety controller are no range within its limits, and do not hold"
            ));
        }
        return hard;
    }
    if both != hard {
        notes.push(format!(
            "joint `{name}`: the soft limits of its safety controller hold, {} and {} within {} and {}",
            both.lower, both.upper, hard.lower, hard.upper
        ));
    }
    both
}

#[cfg(test)]
mod tests {
    use crate::fourier::Interval;
    use crate::robot::Robot;

    #[test]
    fn a_joint_rests_at_0_or_as_near_to_it_as_it_may() {
        for (limits, expected) in [([-1.0, 2.0], 0.0), ([0.5, 2.0], 0.5), ([-2.0, -0.5], -0.5)] {
            let robot = Robot::from_urdf(&format!(
                r#"<robot name="r"><link name="base"/><link name="arm"/>
                <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
                <limit lower="{}" upper="{}" velocity="1" effort="1"/></joint></robot>"#,
                limits[0], limits[1]
            ))
            .unwrap();
            assert_eq!(robot.rest(), [expected], "{limits:?}");
        }
    }

    #[test]
    fn soft_limits_hold_where_they_are_the_narrower_ones() {
        for (soft, expected) in [
            ([-0.5, 0.4], [-0.5, 0.4]),
            ([-2.0, 0.4], [-1.0, 0.4]),
            ([-0.5, 2.0], [-0.5, 1.0]),
            ([-2.0, 2.0], [-1.0, 1.0]),
            ([0.0, 0.0], [-1.0, 1.0]),
            ([2.0, 3.0], [-1.0, 1.0]),
        ] {
            let robot = Robot::from_urdf(&format!(
                r#"<robot name="r"><link name="base"/><link name="arm"/>
                <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
                <limit lower="-1" upper="1" velocity="1" effort="1"/>
                <safety_controller k_velocity="1" soft_lower_limit="{}" soft_upper_limit="{}"/></joint></robot>"#,
                soft[0], soft[1]
            ))
            .unwrap();
            let [lower, upper] = expected;
            let found = robot.properties(0).position;
            assert_eq!(found, Some(Interval { lower, upper }), "{soft:?}");
        }
    }
}
