//! Overrides of the study that a command line runs: seed, grade of the sensor, any key.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use proofmass_study::{Assignment, Overrides, Preset};

/// Options that change the study before it is run.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Changed {
    /// Seed, overriding the study's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Typical sensor of this grade, for each error that the study does not give itself
    #[arg(long, value_parser = presets(), value_name = "GRADE")]
    pub preset: Option<Preset>,
    /// Set any key of the study: dotted path and TOML value, also inside a draw (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Assignment>,
}

impl Changed {
    /// For reading the study, with this many members if any are given.
    pub fn overrides(&self, members: Option<u64>) -> Overrides {
        let Self { seed, preset, set } = self.clone();
        Overrides { members, seed, preset, set }
    }

    /// Returns them as words of a command line.
    pub fn as_arguments(&self, members: Option<u64>) -> Vec<String> {
        let numbers = [("--members", members), ("--seed", self.seed)];
        let numbers = numbers.into_iter().filter_map(|(name, number)| Some([name.to_owned(), number?.to_string()]));
        let preset = self.preset.iter().map(|preset| ["--preset".to_owned(), preset.name().to_owned()]);
        let set = self.set.iter().map(|assignment| ["--set".to_owned(), assignment.to_string()]);
        numbers.chain(preset).chain(set).flatten().collect()
    }
}

/// Parses `--preset`.
fn presets() -> impl TypedValueParser<Value = Preset> {
    let values = Preset::ALL.map(|preset| {
        let help = match preset {
            Preset::Consumer => "ICM-20948, phone or drone grade, uncalibrated",
            Preset::Industrial => "ADIS16470, factory-calibrated MEMS",
            Preset::Tactical => "STIM300, high-end MEMS",
            Preset::Navigation => "HG9900, ring-laser gyros",
        };
        PossibleValue::new(preset.name()).help(help)
    });
    PossibleValuesParser::new(values).try_map(|name| {
        let preset = Preset::ALL.into_iter().find(|preset| preset.name() == name);
        preset.ok_or_else(|| format!("no preset is called {name}"))
    })
}
