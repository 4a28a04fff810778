//! `undulate check`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::demands::{Apart, Demands};
use super::moves::{Course, Loaded, MoveArguments};
use super::pairs::{self, PairArguments};
use super::robot::{Reading, RobotArguments, tell_notes};
use super::trajectory::Form;
use super::verdict::{
    codes, collision_json, collision_words, effort_table, efforts_json, limit_json, limit_source,
    limit_table, millimetres,
};
use super::{Outcome, output};
use crate::collision::{Certificate, Certification, CollisionModel, PairContacts, ProfileInterval};
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::feasibility::{CheckOptions, LimitUse, Verdict, limits_with, without_velocity_limit};
use crate::figure::{ClearanceCourse, clearance};
use crate::fourier::Derivative;
use crate::motion::Motion;
use crate::robot::{JointKind, Robot};

/// Intervals of a figure.
const COLUMNS: usize = 600;
/// How exactly a figure tells the clearance \[m\].
const DRAWN: f64 = 2e-4;
/// Width and height of a panel of the figure \[px\].
const PANEL: (u32, u32) = (900, 360);

/// Check a wave or a recorded move on a robot: limits, and a proof that it keeps clear of itself and of a scene.
#[derive(Args)]
#[command(
    after_help = "MOTION is a wave file, or a move of the robot's own joints: CSV with times, JSON with the fields of trajectory_msgs/JointTrajectory, or\n\
    the YAML of play_motion2; the move is taken as the spline that joint_trajectory_controller runs. Limits are held against rigorous bounds over the\n\
    whole motion, and the proof holds between samples too. What cannot be checked does not pass. Each reason for that is a line `reason: CODE`, and an\n\
    entry of `reasons` with --json; codes are stable, see --reasons. Exit codes: 0 passes, 1 an input cannot be used, 2 the command line is wrong,\n\
    3 does not pass.\n\n\
    Examples:\n  \
    undulate check wave.json --robot wave_arm --margin 0.005 --tolerance 0.1deg --figure clearance.svg\n  \
    undulate check wave.json --robot my.urdf --map my.toml --meshes meshes/ --srdf my.srdf --scene table.toml --certificate wave.cert.json\n  \
    undulate check nod.csv motions.yaml --all-motions --robot my.urdf --max-acceleration 8 --json\n  \
    undulate check --reasons"
)]
pub(super) struct Arguments {
    /// Wave files and recorded moves.
    #[arg(value_name = "MOTION", required_unless_present = "reasons")]
    motions: Vec<PathBuf>,
    /// A URDF file, or the name of a shipped robot (`wave_arm`).
    #[arg(long, value_name = "URDF|NAME", required_unless_present = "reasons")]
    robot: Option<String>,
    /// A joint map (TOML) for waves, or the name of a shipped one. Default: for a shipped robot, the shipped map that fits the joints; else
    /// equal names.
    #[arg(long, value_name = "TOML|NAME")]
    map: Option<String>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    moves: MoveArguments,
    #[command(flatten)]
    demands: Demands,
    #[command(flatten)]
    apart: Apart,
    #[command(flatten)]
    pairs: PairArguments,
    /// Write the proof, with all that it rests on, where the motion passes: what `undulate verify` looks at again.
    #[arg(long, value_name = "FILE.json")]
    certificate: Option<PathBuf>,
    /// Draw the clearance over time, a panel a motion.
    #[arg(long, value_name = "FILE.svg|FILE.png")]
    figure: Option<PathBuf>,
    /// Print the table of reasons, and nothing else.
    #[arg(long)]
    reasons: bool,
}

/// What became of one motion.
struct Answer {
    name: String,
    has_limits: bool,
    held: Vec<(String, f64)>,
    warnings: Vec<String>,
    limits: Vec<LimitUse>,
    verdict: Option<Verdict>,
    profile: Vec<ProfileInterval>,
    certificate: Option<Certificate>,
    error: Option<Error>,
}

impl Answer {
    fn of_error(name: String, error: Error) -> Self {
        Self {
            name,
            has_limits: true,
            held: Vec::new(),
            warnings: Vec::new(),
            limits: Vec::new(),
            verdict: None,
            profile: Vec::new(),
            certificate: None,
            error: Some(error),
        }
    }

    fn reasons(&self) -> Vec<Reason> {
        let mut reasons = match &self.verdict {
            Some(verdict) => verdict.reasons(),
            None => self.limits.iter().filter_map(LimitUse::reason).collect(),
        };
        reasons.extend((!self.has_limits).then_some(Reason::LimitMissing));
        reasons.extend(self.error.as_ref().map(Reason::of));
        reasons.sort_unstable();
        reasons.dedup();
        reasons
    }
}

/// All that motions are held against.
struct Gate<'a> {
    robot: &'a Robot,
    /// Or why there is none: limits can be told all the same.
    collision: &'a Result<CollisionModel>,
    options: &'a CheckOptions,
    /// Where limits come from that are not the robot's.
    given: &'a str,
    /// What is to be said of every motion.
    warnings: Vec<String>,
    /// Whether a limit of velocity is known of every joint.
    has_limits: bool,
    arguments: &'a Arguments,
    target: &'a RobotArguments,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    if arguments.reasons {
        let rows: Vec<Vec<String>> = Reason::ALL
            .iter()
            .map(|r| vec![format!("{:<22}{}", r.code(), r.meaning())])
            .collect();
        let value: Value = Reason::ALL
            .iter()
            .map(|r| json!({"code": r.code(), "meaning": r.meaning()}))
            .collect();
        output::report(json, &json!({"reasons": value}), || {
            output::table(&[&format!("{:<22}meaning", "code")], &rows)
        });
        return Ok(Outcome::Done);
    }
    let looked_at = look(arguments, json);
    looked_at.unwrap_or_else(|error| {
        // Whatever went wrong, nobody who reads the report may take it for a yes.
        let reasons = [Reason::of(&error)];
        let value = json!({
            "passes": false,
            "reasons": codes(&reasons),
            "error": error.to_string(),
        });
        output::report(json, &value, || reason_lines(&reasons).join("\n"));
        Err(error)
    })
}

/// The inner result is of what was reported already.
fn look(arguments: &Arguments, json: bool) -> Result<Result<Outcome>> {
    let form = arguments.figure.as_deref().map(Form::of).transpose()?;
    let target = RobotArguments {
        robot: arguments.robot.clone().unwrap_or_default(),
        map: arguments.map.clone(),
        reading: arguments.reading.clone(),
    };
    let robot = target.reading.robot(&target.robot)?;
    let notes = tell_notes(&robot);
    let (options, given) = arguments.demands.options(&robot)?;
    let apart = arguments.apart.options(&arguments.reading, &robot)?;
    let scene: Vec<String> = apart
        .scene
        .objects()
        .iter()
        .map(|o| o.name.clone())
        .collect();
    let collision = CollisionModel::new(&robot, &apart);
    let mut warnings = Vec::new();
    let unlimited = without_velocity_limit(&robot, &options.limits);
    if !unlimited.is_empty() {
        warnings.push(format!(
            "no velocity limit is known of {} (in a URDF 0 says none): give one with --max-velocity or --limits",
            unlimited.join(", ")
        ));
    }
    if let Err(error) = robot.require_dynamics() {
        warnings.push(format!("efforts are not looked at: {error}"));
    }
    let shapeless = pairs::without_shapes(&robot);
    if !shapeless.is_empty() {
        warnings.push(format!(
            "these links move, have no collision shape, and are kept apart from nothing: {}",
            shapeless.join(", ")
        ));
    }
    warnings.iter().for_each(output::warn);
    let mut contacts = None;
    if let Ok(collision) = &collision {
        pairs::tell(collision, &scene);
        contacts = arguments.pairs.contacts(collision, &robot)?;
    }
    let gate = Gate {
        robot: &robot,
        collision: &collision,
        options: &options,
        given: &given,
        warnings,
        has_limits: unlimited.is_empty(),
        arguments,
        target: &target,
    };
    let motions: Vec<(String, Result<Loaded>)> = arguments
        .motions
        .iter()
        .flat_map(|path| arguments.moves.open(path, &robot, &target))
        .collect();
    if arguments.certificate.is_some() && motions.len() != 1 {
        return Err(Error::new(
            ErrorKind::Setting,
            format!("--certificate for {} motions", motions.len()),
        )
        .expected("one motion"));
    }
    let answers: Vec<Answer> = motions
        .into_iter()
        .map(|(name, loaded)| match loaded {
            Ok(loaded) => gate.answer(name, loaded),
            Err(error) => Answer::of_error(name, error),
        })
        .collect();
    for warning in answers.iter().flat_map(|a| &a.warnings) {
        output::warn(warning);
    }
    let mut written = Vec::new();
    if let (Some(path), Some(certificate)) = (
        &arguments.certificate,
        answers.first().and_then(|a| a.certificate.as_ref()),
    ) {
        output::write(path, certificate.to_json().as_bytes())?;
        written.push(path.display().to_string());
    }
    if let (Some(path), Some(form)) = (&arguments.figure, form)
        && answers.iter().any(|a| !a.profile.is_empty())
    {
        let bytes = form.bytes(figure(&answers, options.margin)?);
        output::write(path, &bytes)?;
        written.push(path.display().to_string());
    }
    Ok(gate.report(answers, contacts.as_deref(), &notes, &written, json))
}

impl Gate<'_> {
    fn answer(&self, name: String, loaded: Loaded) -> Answer {
        let Loaded {
            course,
            warnings,
            held,
            evidence,
        } = loaded;
        let mut answer = Answer {
            has_limits: self.has_limits,
            held,
            warnings,
            ..Answer::of_error(name, Error::new(ErrorKind::Infeasible, "not looked at"))
        };
        let is_wave = matches!(course, Course::Wave(_));
        answer.error = match course {
            Course::Wave(wave) => self.judge(&*wave, evidence, &mut answer),
            Course::Move(spline) => self.judge(&*spline, evidence, &mut answer),
        }
        .err();
        let many = |l: &&LimitUse| {
            l.quantity == Derivative::Position
                && l.kind == JointKind::Revolute
                && l.excess() > std::f64::consts::TAU
        };
        if !is_wave && let Some(limit) = answer.limits.iter().find(many) {
            answer.warnings.push(format!(
                "{} goes to {:.1} rad: if the angles of this file are degrees, --degrees",
                limit.joint,
                limit.range.magnitude()
            ));
        }
        answer
    }

    fn judge<M: Motion>(
        &self,
        motion: &M,
        evidence: Vec<crate::collision::Evidence>,
        answer: &mut Answer,
    ) -> Result<()> {
        answer.limits = limits_with(self.robot, motion, &self.options.limits)?;
        let collision = self.collision.as_ref().map_err(Clone::clone)?;
        let mut prover = collision.prover();
        let mut verdict = Verdict::with(self.robot, &mut prover, motion, self.options)?;
        if self.arguments.certificate.is_some() && verdict.passes() {
            let mut rests_on = self.target.reading.evidence(&self.target.robot)?;
            rests_on.extend(evidence);
            let sources = answer.limits.iter().map(|l| limit_source(l, self.given));
            let (certification, certificate) = prover.certificate(
                self.robot,
                motion,
                self.options.margin,
                &self.options.tolerance,
                rests_on,
                sources.collect(),
            )?;
            // A proof that is kept has a little to spare, so it may not be had where a bare one was.
            verdict.collision = Some(certification);
            answer.certificate = certificate;
        }
        for touch in collision.disabled_collisions(motion)? {
            let (a, b) = &touch.pair;
            answer.warnings.push(format!(
                "the SRDF disables {a} and {b}, and this motion makes them touch, {} mm deep at {:.3} s; --keep {a}:{b} checks them",
                millimetres(-touch.distance),
                touch.time
            ));
        }
        if self.arguments.figure.is_some() {
            answer.profile = collision.clearance_profile(motion, COLUMNS, DRAWN)?;
        }
        answer.verdict = Some(verdict);
        Ok(())
    }

    /// Says it all, and returns what the program comes to.
    fn report(
        &self,
        answers: Vec<Answer>,
        contacts: Option<&[PairContacts]>,
        notes: &[String],
        written: &[String],
        json: bool,
    ) -> Result<Outcome> {
        let passes = answers.iter().all(|a| a.reasons().is_empty());
        let entries: Vec<Value> = answers.iter().map(|a| self.entry(a)).collect();
        // Of one motion all is in one place; of several, what they share is around them.
        let mut value = match entries.as_slice() {
            [one] => one.clone(),
            _ => {
                let mut reasons: Vec<Reason> = answers.iter().flat_map(Answer::reasons).collect();
                reasons.sort_unstable();
                reasons.dedup();
                json!({"passes": passes, "reasons": codes(&reasons), "motions": entries})
            }
        };
        value["robot"] = json!(self.robot.name());
        value["notes"] = json!(notes);
        let mut warnings = self.warnings.clone();
        if let [one] = answers.as_slice() {
            warnings.extend_from_slice(&one.warnings);
        }
        value["warnings"] = json!(warnings);
        value["pairs"] = match self.collision {
            Ok(collision) => self.arguments.pairs.json(collision, contacts),
            Err(_) => Value::Null,
        };
        value["written"] = json!(written);
        output::report(json, &value, || {
            let mut blocks = Vec::new();
            if let Some(contacts) = contacts {
                blocks.push(self.arguments.pairs.table(contacts));
            }
            blocks.extend(answers.iter().map(|a| self.words(a, answers.len() > 1)));
            if !written.is_empty() {
                blocks.push(format!("wrote {}", written.join(", ")));
            }
            blocks.join("\n\n")
        });
        let mut errors: Vec<Error> = answers.into_iter().filter_map(|a| a.error).collect();
        let last = errors.pop();
        errors.iter().for_each(output::failure);
        match last {
            Some(error) => Err(error),
            None if passes => Ok(Outcome::Done),
            None => Ok(Outcome::Refused),
        }
    }

    fn entry(&self, answer: &Answer) -> Value {
        let reasons = answer.reasons();
        json!({
            "motion": answer.name,
            "passes": reasons.is_empty(),
            "reasons": codes(&reasons),
            "warnings": answer.warnings,
            "held": answer.held.iter().map(|(j, p)| (j.clone(), json!(p))).collect::<serde_json::Map<_, _>>(),
            "limits": answer.limits.iter().map(limit_json).collect::<Vec<_>>(),
            "efforts": answer.verdict.as_ref().map(efforts_json),
            "collision": answer.verdict.as_ref().map(|v| collision_json(v, self.options, self.robot.joints())),
            "error": answer.error.as_ref().map(ToString::to_string),
        })
    }

    fn words(&self, answer: &Answer, is_named: bool) -> String {
        let mut lines = Vec::new();
        if is_named {
            lines.push(answer.name.clone());
        }
        if !answer.held.is_empty() {
            let held: Vec<String> = answer
                .held
                .iter()
                .map(|(joint, position)| format!("{joint} at {position}"))
                .collect();
            lines.push(format!("joints that stand still: {}", held.join(", ")));
        }
        if !answer.limits.is_empty() {
            lines.push(limit_table(&answer.limits));
        }
        if let Some(efforts) = answer.verdict.as_ref().and_then(|v| v.efforts.as_ref()) {
            lines.push(effort_table(efforts));
        }
        if let (Some(verdict), Ok(collision)) = (&answer.verdict, self.collision) {
            let pairs = collision.pairs();
            let checked = pairs.iter().filter(|p| p.is_checked()).count();
            lines.extend(collision_words(
                verdict,
                self.options,
                checked,
                pairs.len() - checked,
            ));
        }
        let reasons = answer.reasons();
        lines.extend(reason_lines(&reasons));
        if self.arguments.certificate.is_some() && answer.certificate.is_none() {
            lines.push("no certificate is written".to_owned());
        }
        lines.push(
            match reasons.is_empty() {
                true => "passes",
                false => "does not pass",
            }
            .to_owned(),
        );
        lines.join("\n")
    }
}

fn reason_lines(reasons: &[Reason]) -> Vec<String> {
    reasons.iter().map(|r| format!("reason: {r}")).collect()
}

fn figure(answers: &[Answer], margin: f64) -> Result<crate::figure::Picture> {
    let drawn: Vec<&Answer> = answers.iter().filter(|a| !a.profile.is_empty()).collect();
    let courses: Vec<ClearanceCourse<'_>> = drawn
        .iter()
        .map(|answer| ClearanceCourse {
            title: if answers.len() > 1 { &answer.name } else { "" },
            profile: &answer.profile,
            margin,
            undecided: match answer.verdict.as_ref().and_then(|v| v.collision.as_ref()) {
                Some(Certification::Undecided { stretches, .. }) => stretches,
                _ => &[],
            },
        })
        .collect();
    let size = (PANEL.0, PANEL.1.saturating_mul(courses.len() as u32));
    clearance(&courses, 1, size)
}
