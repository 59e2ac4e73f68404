//! The one test binary. A sentence per module; tests that need an adapter or the data folder are listed at run time and
//! shown as ignored, with the reason, where it is absent.

mod suite {
    pub mod ac_coupled;
    pub mod aiding;
    pub mod allan;
    pub mod architecture;
    pub mod bench;
    pub mod benchmarks;
    #[cfg(unix)]
    pub mod bombs;
    pub mod book;
    pub mod carried_over;
    pub mod carried_over_driven;
    pub mod carried_over_mass;
    pub mod carried_over_tumble;
    pub mod check;
    pub mod check_beyond;
    pub mod check_rest;
    pub mod cli;
    pub mod clock;
    pub mod closed_form;
    pub mod colours;
    pub mod convergence;
    pub mod creeping_friction;
    pub mod decays;
    pub mod dense_decays;
    pub mod device_faults;
    pub mod diagnose_cli;
    pub mod diagnose_rest_cli;
    pub mod diagnosis_driven;
    pub mod diagnosis_rest;
    pub mod diagnosis_trajectory;
    pub mod diagnosis_tumble;
    pub mod digits;
    pub mod documents;
    pub mod driven_bad_input;
    pub mod driven_modes;
    pub mod dynamics;
    pub mod emit;
    pub mod export;
    pub mod far_from_linear;
    pub mod flown;
    pub mod following;
    pub mod formats;
    pub mod fuzz;
    pub mod held_chaos;
    pub mod held_inputs;
    pub mod hostile_names;
    pub mod instruments;
    pub mod invariance;
    pub mod kept_shapes;
    pub mod kills;
    pub mod law;
    pub mod laws;
    pub mod limits;
    pub mod long_decays;
    pub mod lost_rows;
    pub mod mistakes;
    pub mod modes;
    pub mod motion;
    pub mod motion_keys;
    pub mod near_laws;
    pub mod next_command;
    pub mod no_resonator;
    pub mod noise_law;
    pub mod numbers;
    pub mod one_sided_stop;
    pub mod outputs;
    #[cfg(unix)]
    pub mod outputs_elsewhere;
    pub mod own_integration;
    pub mod own_noise;
    pub mod own_states;
    pub mod pages;
    pub mod paper;
    pub mod parity;
    pub mod plan;
    pub mod planted;
    pub mod powers;
    pub mod ranks;
    pub mod read_linear;
    pub mod read_quantity;
    pub mod readout;
    pub mod recording;
    pub mod recording_atlas;
    pub mod report;
    pub mod require;
    pub mod resume_in_motion;
    pub mod risk;
    pub mod rows;
    pub mod same_verdict;
    pub mod samples;
    pub mod scale;
    pub mod schema;
    pub mod settings_above;
    pub mod several_recordings;
    pub mod shards;
    pub mod shards_in_motion;
    pub mod shards_map_trial;
    pub mod shares;
    pub mod single_sine;
    pub mod slow_columns;
    pub mod slow_in_motion;
    pub mod spoiled_decays;
    pub mod start_search;
    pub mod still_start;
    pub mod strapdown;
    pub mod study;
    pub mod study_cli;
    pub mod sweep;
    pub mod sweeps;
    pub mod tiers;
    pub mod tilt;
    pub mod touchstone;
    pub mod trial;
    pub mod tumble_axes;
    pub mod tumble_bench;
    pub mod tumble_units;
    pub mod tumble_wander;
    pub mod turntable;
    pub mod tutorials;
    pub mod units;
    pub mod unlike_members;
    pub mod variance;
    pub mod warm_spring;
    pub mod warm_start;
    pub mod windows;
    pub mod world;
}

use libtest_mimic::{Arguments, Trial};

fn main() {
    // Silences a line that Mesa's device selection prints on machines without a desktop.
    // SAFETY: no other thread exists yet that could read the environment.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    let arguments = Arguments::from_args();
    // T1: laws, files, commands, pages.
    let tests = [
        // world: what the tests compare with fails where it must.
        suite::world::tests(),
        // architecture: imports run one way, heavy crates have one owner.
        suite::architecture::tests(),
        // cli: the commands answer as the contract says.
        suite::cli::tests(),
        // outputs: a run replaces its own files and nobody else's.
        suite::outputs::tests(),
        // bombs: files that claim gigabytes or visits without end are answered.
        #[cfg(unix)]
        suite::bombs::tests(),
        // outputs_elsewhere: folders laid out by somebody else remove and write nothing outside.
        #[cfg(unix)]
        suite::outputs_elsewhere::tests(),
        // pages: what a reader sees is whole at every width, and figures answer.
        suite::pages::tests(),
        // colours: inks differ for every reader.
        suite::colours::tests(),
        // hostile_names: headings, units and paths of any text are written so that they can be read back.
        suite::held_inputs::tests(),
        suite::hostile_names::tests(),
        // mistakes: what a newcomer does wrong is refused in a sentence.
        suite::mistakes::tests(),
        // law: random numbers and error growth follow their laws, and the controls fail.
        suite::law::tests(),
        // motion: trajectories from files, and what is wrong with them.
        suite::motion::tests(),
        // flown: recorded flights in windows beside the predicted bands.
        suite::flown::tests(),
        // convergence: integrators have their order, f32 stays below the noise.
        suite::convergence::tests(),
        // parity: CPU and GPU agree.
        suite::parity::tests(),
        // readout: a low-pass and a delay behind the proof mass follow their closed forms.
        suite::powers::tests(),
        suite::ac_coupled::tests(),
        suite::read_linear::tests(),
        suite::read_quantity::tests(),
        suite::readout::tests(),
        // laws: the same law in both precisions, on both backends, in the diagnosis and as the trial wrote it.
        suite::laws::tests(),
        // own_states: laws with states of their own, in a study.
        suite::own_states::tests(),
        // invariance: the same bits for any tile, batch, thread, lane and interruption.
        suite::invariance::tests(),
        // shards: divided runs merge to the bits of one, and what does not belong together is refused by name.
        suite::shards::tests(),
        suite::shards_in_motion::tests(),
        suite::shards_map_trial::tests(),
        // emit: scripts for batch systems run by a plain shell.
        suite::emit::tests(),
        // ranks: mpirun shares a study, or is refused.
        suite::ranks::tests(),
        // scale: fleets begin in bounded memory.
        suite::scale::tests(),
        // allan: coefficients come back from a signal made of them, covered as claimed.
        suite::allan::tests(),
        // recording: files are read as they are, or refused with a reason.
        suite::recording::tests(),
        // rows: none is lost without a word, whatever happened to the file.
        suite::risk::tests(),
        suite::rows::tests(),
        // clock: one clock for all readers.
        suite::clock::tests(),
        // diagnose_rest_cli: a sensor at rest at the command line; every kind's repaired model runs in a study.
        suite::diagnose_rest_cli::tests(),
        // dynamics: Duffing orbits match analysis, print and each other.
        suite::dynamics::tests(),
        // paper: twenty figures, every check holds and can fail.
        suite::paper::tests(),
        // diagnose: the contract's files and fields, and bad input in sentences.
        suite::diagnose_cli::tests(),
        // documents: what --json prints is what its schema says.
        suite::documents::tests(),
        // driven_bad_input: damaged recordings of a proof mass are refused in a sentence or survived and mentioned.
        suite::driven_bad_input::tests(),
        // units: the unit that a file states holds, whatever names its columns.
        suite::units::tests(),
        // benchmarks: public ones, and a body without a spring.
        suite::benchmarks::tests(),
        // strapdown: six axes drift as theory says, at rest and over the Earth.
        suite::strapdown::tests(),
        // slow_in_motion: errors with a time of their own along a trajectory, ensemble against covariance.
        suite::slow_in_motion::tests(),
        // aiding: outages, zero-velocity updates, filter and reset.
        suite::aiding::tests(),
        // following: errors that follow temperature and late stamps.
        suite::following::tests(),
        // motion_keys: vibration and the navigator's integrator do what their laws say.
        suite::motion_keys::tests(),
        // resume_in_motion: a stopped flight ends with the same bits.
        suite::resume_in_motion::tests(),
        // study: a study is read as it is meant, or refused in a sentence.
        suite::study::tests(),
        // tilt: a study along one axis says from when on its small angles are too large.
        suite::tilt::tests(),
        // sweep: a study along one key or over two, beside the closed form.
        suite::sweep::tests(),
        // trial: the blind trial is blind, and its scoring can tell an oracle from a coin.
        suite::trial::tests(),
        // turntable: a gyro on a turntable is held against the table's rate, and is not at rest.
        suite::turntable::tests(),
        // recording_atlas: pages on real recordings say what the other commands say.
        suite::recording_atlas::tests(),
        // closed_form: every error source alone drifts as its law says.
        suite::closed_form::tests(),
        // variance: whose variance a position error has, next to closed forms.
        suite::variance::tests(),
        // unlike_members: what only some members of a study have.
        suite::unlike_members::tests(),
        // warm_spring: a spring that follows the temperature, in a study.
        suite::warm_spring::tests(),
        // warm_start: what a still start takes off what follows the temperature.
        suite::warm_start::tests(),
        // windows: a recorded log beside its prediction.
        suite::windows::tests(),
        // next_command: `inspect` names the command that a file is for.
        suite::next_command::tests(),
        // noise_law: every noise term has the Allan deviation of its coefficient.
        suite::noise_law::tests(),
        // device_faults: a device that fails costs neither the run nor what was done.
        suite::device_faults::tests(),
        // formats: one log gives one answer in every format; what is damaged ends in words.
        suite::formats::tests(),
        // numbers: a table behind every figure.
        suite::numbers::tests(),
        // one_sided_stop: a stop on one side of the proof mass.
        suite::one_sided_stop::tests(),
        // schema: editors know the keys that the tool knows.
        suite::schema::tests(),
        suite::samples::tests(),
        // export: what other tools make of an exported file is the study's noise.
        suite::export::tests(),
        // fuzz: any bytes are read as they are or refused in words, and what is written can be read.
        suite::fuzz::tests(),
        // kills: a run that is killed or stopped goes on, and ends with the same bits.
        suite::kills::tests(),
        // limits: small disks, files and memories end in words.
        suite::limits::tests(),
        // lost_rows: noise at rest with rows missing.
        suite::lost_rows::tests(),
        // study_cli: refusals leave nothing behind, Ctrl-C leaves what --resume continues from.
        suite::study_cli::tests(),
        // tutorials: every command of a page prints what stands there.
        suite::tutorials::tests(),
        // sweeps: jumps follow the history of each sweep; recorded sweeps give their numbers.
        suite::sweeps::tests(),
        // touchstone: one resonance in three forms is that of a table of its numbers.
        suite::touchstone::tests(),
        // instruments: headings of lock-ins and analysers; thermomechanical noise.
        suite::instruments::tests(),
        // settings_above: settings of instruments above the headings are left out and said.
        suite::settings_above::tests(),
    ];
    // T2: campaigns of verdicts.
    let campaigns = [
        // start search: it finds the local minima that a few starts miss; profiles are what refits give.
        suite::slow_columns::tests(),
        suite::start_search::tests(),
        suite::single_sine::tests(),
        // static: each effect at rest is found alone, nothing where nothing is.
        suite::diagnosis_rest::tests(),
        // carried_over: what a diagnosis at rest names, a study of its repaired sensor runs.
        suite::carried_over::tests(),
        // carried_over_driven: what is named of a readout.
        suite::carried_over_driven::tests(),
        // carried_over_mass: what is named of a proof mass and its readout, by value.
        suite::carried_over_mass::tests(),
        // carried_over_tumble: what is named of poses, axis by axis.
        suite::carried_over_tumble::tests(),
        // far_from_linear: what follows no linear oscillator gets a verdict, what follows nothing an error.
        suite::far_from_linear::tests(),
        // no_resonator: a gyro on a rate table is no proof mass.
        suite::no_resonator::tests(),
        // trajectory: what is concealed in the log of a flight is found, and nothing else.
        suite::diagnosis_trajectory::tests(),
        // tumble: planted physics of an IMU in still poses is named, and nothing else.
        suite::diagnosis_tumble::tests(),
        // tumble: exchanged and reversed axes are said.
        suite::tumble_axes::tests(),
        // tumble: the unit of a heading holds, unless what was read contradicts it.
        suite::tumble_units::tests(),
        // tumble: a wander of 1/f noise is no mismatch.
        suite::tumble_wander::tests(),
        // diagnosis_driven: planted physics is named, foreign physics is not, and a real circuit's spring is found.
        suite::diagnosis_driven::tests(),
        // decay: a free decay's laws are named together, with shares, at every rate.
        suite::decays::tests(),
        // creeping_friction: dry friction that is smooth about standstill.
        suite::creeping_friction::tests(),
        suite::dense_decays::tests(),
        suite::modes::tests(),
        suite::driven_modes::tests(),
        suite::long_decays::tests(),
        suite::spoiled_decays::tests(),
        // held_chaos: chaotic motion under an input that is held between its samples.
        suite::held_chaos::tests(),
        // shares: under an input, each name with the part of the error that it removes.
        suite::shares::tests(),
        // sweeps: planted laws are named, noise and a background are not.
        suite::sweeps::campaigns(),
        // tutorials: the example of each candidate of the reference is named.
        suite::tutorials::campaigns(),
        // check: what a recording can know, and whether it says it twice.
        suite::check::tests(),
        suite::check_beyond::tests(),
        suite::check_rest::tests(),
        // plan: the next experiment decides as often as it is said to.
        suite::plan::tests(),
        // several recordings: fitted together, judged by others, refused where they do not belong together.
        suite::several_recordings::tests(),
        // require: the value that a requirement takes is the one of theory, covered as stated.
        suite::report::tests(),
        suite::require::tests(),
        // digits: digits that are declared stable are.
        suite::digits::tests(),
        // planted: a very small blind trial of the real diagnosis.
        suite::planted::tests(),
        // book: the verdict book, divided, resumed and compared.
        suite::book::tests(),
        // still_start: what averaging the first seconds leaves of each error.
        suite::still_start::tests(),
        // kept_shapes: laws with a fitted exponent, and what is near a power without being one.
        suite::kept_shapes::tests(),
        suite::near_laws::tests(),
        suite::own_noise::tests(),
        // own integration: what a navigator errs by itself is in every figure.
        suite::own_integration::tests(),
        // samples: simulated readings are a recording.
        suite::same_verdict::tests(),
    ];
    let all = arguments.filter.is_some() || std::env::var_os("PROOFMASS_ALL").is_some();
    let campaigns = suite::tiers::campaigns(campaigns.into_iter().flatten().collect(), all);
    let tests: Vec<Trial> = tests.into_iter().flatten().chain(campaigns).collect();
    let failed = libtest_mimic::run(&arguments, tests).has_failed();
    println!("{}", suite::tiers::slowest());
    leave(if failed { 101 } else { 0 });
}

/// Ends without the clean-up that libraries registered: Mesa's frees twice now and then when a software device was the last
/// to go (seen twice in some hundred runs of this suite), and would turn a passed suite into an abort.
fn leave(code: i32) -> ! {
    let _ = std::io::Write::flush(&mut std::io::stdout());
    #[cfg(unix)]
    // SAFETY: ends the process; everything printed is flushed and no file of a test is open.
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}
