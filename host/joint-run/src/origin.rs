//! Provenance of a run, the head of its record: joint, image, settings and host, all known before the run.

use link::messages::{Clock, ClockSource, Hello, RunMode};
use model_core::gears::Kinematics;

use crate::plan::{RunPlan, RunRequest};
use crate::record::{Identity, Image, JointFigures, RunRecord, Settings};
use board::device::image;
use report::provenance;

/// Record before the run.
pub fn record(request: &RunRequest<'_>, plan: &RunPlan, transport: &str) -> RunRecord {
    let emulated = request.line.port.is_none();
    let identity = Identity {
        joint: plan.expected.joint.clone(),
        joint_file: plan.name.clone(),
        joint_digest: format!("{:016x}", plan.expected.digest),
        emulated,
        transport: transport.to_owned(),
        git_commit: provenance::git_commit(),
        host: provenance::host(),
        host_version: provenance::VERSION.to_owned(),
        date: provenance::date(),
        ..Identity::default()
    };
    RunRecord::new(identity, joint_figures(plan), settings(request, plan))
}

/// Notes the board's statements about itself.
pub fn note_board(identity: &mut Identity, hello: &Hello) {
    let [major, minor, patch] = hello.firmware_version;
    identity.role = image::role_name(hello.role).to_owned();
    identity.board = hello.board.to_string();
    identity.firmware_version = format!("{major}.{minor}.{patch}");
    identity.clock = clock_text(hello.clock);
    identity.emulated |= hello.clock.source == ClockSource::NotModelled;
    identity.last_panic = hello.last_panic.as_ref().map(ToString::to_string);
    identity.watchdog_reset = hello.watchdog_reset;
    identity.forced = hello.forced;
}

/// Text on the board's core clock.
pub fn clock_text(clock: Clock) -> String {
    let source = match clock.source {
        ClockSource::Crystal => "crystal and PLL, measured before use".to_owned(),
        ClockSource::Signal => "clock from elsewhere and PLL, measured before use".to_owned(),
        ClockSource::Internal => "internal oscillator and PLL".to_owned(),
        ClockSource::DidNotStart => {
            "internal oscillator and PLL: the source in the board file did not start".to_owned()
        }
        ClockSource::OtherFrequency { measured } => format!(
            "internal oscillator and PLL: what came from outside was measured as {:.2} MHz, which is not what the board file says",
            f64::from(measured) / 1e6
        ),
        ClockSource::Failed => "no PLL came up: the tick rate is not the stated one".to_owned(),
        ClockSource::NotModelled => "not modelled: emulated board".to_owned(),
    };
    match clock.tolerance {
        0 => source,
        ppm => format!("{source}; exact to {} %", f64::from(ppm) / 1e4),
    }
}

/// Image for the record.
pub fn image(image: &image::Image) -> Image {
    Image {
        file: image.elf.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        elf_sha256: image.sha256.clone(),
        flash_bytes: image.flash_bytes,
        ram_bytes: image.ram_bytes,
        compiler: image.compiler.clone(),
        flags: image.flags.clone(),
    }
}

fn joint_figures(plan: &RunPlan) -> JointFigures {
    let parameters = &plan.joint.parameters;
    let half_backlash_m: Vec<f64> = [&parameters.sun_planet, &parameters.ring_planet]
        .into_iter()
        .flat_map(|mesh| mesh.half_backlash.clone())
        .collect();
    // Every mesh is free while the gap is within the sum of both meshes' half-backlash for every planet.
    let planets = parameters.geometry.planets;
    let reach = (0..planets).map(|planet| half_backlash_m[planet] + half_backlash_m[planets + planet]);
    let reach = reach.fold(f64::INFINITY, f64::min);
    JointFigures {
        planets,
        ratio: parameters.geometry.ratio_by_radii(),
        half_backlash_m,
        gap_band_m: [-reach, reach],
        lost_motion_rad: reach / parameters.geometry.carrier_base_radius(),
    }
}

fn settings(request: &RunRequest<'_>, plan: &RunPlan) -> Settings {
    let realtime = plan.settings.mode == RunMode::Realtime;
    Settings {
        mode: if realtime { "realtime" } else { "lockstep" }.to_owned(),
        tick_rate_hz: request.rate,
        method: plan.substeps.method().to_owned(),
        substeps: plan.substeps.count(),
        decimation: plan.settings.decimation.into(),
        ticks: plan.profile.ticks,
        command_timeout_ticks: request.line.port.is_some().then_some(plan.settings.command_timeout),
        profile: plan.profile.name.clone(),
        seed: 0,
        replay: request.replay_command(),
    }
}
