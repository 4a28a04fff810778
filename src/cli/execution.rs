//! How a motion is executed, as arguments.

use clap::{Args, ValueEnum};

use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;
use crate::simulation::{Control, Payload, Plant, Push, Pushed, SimulationOptions};

#[derive(Clone, Copy, ValueEnum)]
enum PlantName {
    /// A Rapier multibody: first order.
    Rapier,
    /// Runge-Kutta of fourth order on this program's own dynamics: faster, and the measure of the other.
    Rk4,
}

/// Plant and controller.
#[derive(Args)]
pub(super) struct ExecutionArguments {
    /// What integrates the equations of motion.
    #[arg(long, value_enum, default_value_t = PlantName::Rapier)]
    plant: PlantName,
    /// How long [s], a whole number of steps [default: the move, or one period].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Step of the integration [s].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = SimulationOptions::default().time_step)]
    time_step: f64,
    /// How often the controller sends [s], a whole number of steps [default: every step].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    controller_period: Option<f64>,
    /// Natural frequency of the position loops [Hz].
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true, default_value_t = SimulationOptions::default().bandwidth)]
    bandwidth: f64,
    /// Iterations of Rapier's solver in a step.
    #[arg(long, value_name = "COUNT", default_value_t = SimulationOptions::default().solver_iterations)]
    solver_iterations: usize,
    /// Motors alone, without the torque that the model says the motion needs.
    #[arg(long)]
    no_feed_forward: bool,
    /// Without observing what the feed-forward misses: springs yield to it.
    #[arg(long)]
    no_observer: bool,
    /// Motors give whatever is asked of them.
    #[arg(long)]
    no_effort_limits: bool,
    /// Viscous damping of every joint [N m s/rad, N s/m], instead of the URDF's; the controller does not know.
    #[arg(long, value_name = "DAMPING", allow_negative_numbers = true)]
    damping: Option<f64>,
    /// Coulomb friction of every joint [N m, N], instead of the URDF's; the controller does not know.
    #[arg(long, value_name = "FRICTION", allow_negative_numbers = true)]
    friction: Option<f64>,
    /// By what share all of the feed-forward is too large; negative: too small.
    #[arg(
        long,
        value_name = "SHARE",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    torque_error: f64,
    /// A mass [kg] on a link, at X,Y,Z in its frame [m] or at its origin; the controller does not know.
    #[arg(long, value_name = "LINK=KG[@X,Y,Z]")]
    payload: Option<String>,
    /// A push: a force [N] at the origin of a link, or an effort [N m, N] on a joint, from one time to another [s]; may be given several times.
    #[arg(long, value_name = "LINK=X,Y,Z@FROM..TO|JOINT=EFFORT@FROM..TO")]
    push: Vec<String>,
}

impl ExecutionArguments {
    pub fn options(&self, robot: &Robot) -> Result<SimulationOptions> {
        Ok(SimulationOptions {
            plant: match self.plant {
                PlantName::Rapier => Plant::Rapier,
                PlantName::Rk4 => Plant::Rk4,
            },
            time_step: self.time_step,
            controller_period: self.controller_period,
            duration: self.duration,
            control: match self.no_feed_forward {
                true => Control::Feedback,
                false => Control::FeedForward,
            },
            bandwidth: self.bandwidth,
            effort_limits: !self.no_effort_limits,
            solver_iterations: self.solver_iterations,
            damping: self.damping,
            friction: self.friction,
            observer: !self.no_observer,
            torque_error: self.torque_error,
            payload: self.payload.as_deref().map(payload).transpose()?,
            pushes: self
                .push
                .iter()
                .map(|text| push(text, robot))
                .collect::<Result<_>>()?,
        })
    }
}

fn payload(text: &str) -> Result<Payload> {
    let wrong = || {
        Error::new(ErrorKind::Setting, format!("--payload {text}"))
            .expected("LINK=KG or LINK=KG@X,Y,Z, such as hand=0.5@0,0,0.1")
    };
    let (link, load) = text.split_once('=').ok_or_else(wrong)?;
    let (mass, center) = load.split_once('@').unwrap_or((load, "0,0,0"));
    let (Some([mass]), Some(center)) = (numbers(mass), numbers::<3>(center)) else {
        return Err(wrong());
    };
    Ok(Payload {
        link: link.trim().to_owned(),
        mass,
        center: center.into(),
    })
}

fn push(text: &str, robot: &Robot) -> Result<Push> {
    let wrong = || {
        Error::new(ErrorKind::Setting, format!("--push {text}"))
            .expected("LINK=X,Y,Z@FROM..TO or JOINT=EFFORT@FROM..TO, such as hand=20,0,0@0.2..0.4")
    };
    let (name, load) = text.split_once('=').ok_or_else(wrong)?;
    let (load, times) = load.split_once('@').ok_or_else(wrong)?;
    let (from, to) = times.split_once("..").ok_or_else(wrong)?;
    let (Some([from]), Some([to])) = (numbers(from), numbers(to)) else {
        return Err(wrong());
    };
    let name = name.trim();
    let on = match (numbers::<1>(load), numbers::<3>(load)) {
        (Some([effort]), _) => {
            robot.joints().index(name)?;
            Pushed::Joint {
                joint: name.to_owned(),
                effort,
            }
        }
        (_, Some(force)) => Pushed::Link {
            link: robot.link(name)?.name.clone(),
            at: nalgebra::Point3::origin(),
            force: force.into(),
        },
        _ => return Err(wrong()),
    };
    Ok(Push { on, from, to })
}

/// So many numbers between commas.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}
