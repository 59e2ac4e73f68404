//! The shaders as text: shared parts first, then the kernel. The only file that knows naga, and only to check.
//!
//! Not for running them: `backend::gpu` does.

/// A shader, ready for a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shader {
    /// Name of its file and of its entry point.
    pub name: &'static str,
    /// WGSL.
    pub text: String,
}

const PHILOX: &str = include_str!("../../shaders/shared/philox.wgsl");
const MULTIPLY_16: &str = include_str!("../../shaders/shared/philox_multiply_16.wgsl");
const MULTIPLY_64: &str = include_str!("../../shaders/shared/philox_multiply_64.wgsl");
const ELEMENTARY: &str = include_str!("../../shaders/shared/elementary.wgsl");
const LAYOUT: &str = include_str!("../../shaders/shared/layout.wgsl");
const OSCILLATOR: &str = include_str!("../../shaders/shared/oscillator.wgsl");
const ACCUMULATE: &str = include_str!("../../shaders/shared/accumulate.wgsl");

/// A kernel's own text behind random numbers and elementary functions; `int64`: the adapter has 64-bit integers.
pub fn with_random_numbers(name: &'static str, text: &str, int64: bool) -> Shader {
    let multiply = if int64 { MULTIPLY_64 } else { MULTIPLY_16 };
    Shader { name, text: [multiply, PHILOX, ELEMENTARY, text].join("\n") }
}

/// The ensemble kernel.
pub fn simulate(int64: bool) -> Shader {
    let own = include_str!("../../shaders/simulate.wgsl");
    with_random_numbers("simulate", &[LAYOUT, OSCILLATOR, ACCUMULATE, own].join("\n"), int64)
}

/// Text that both map kernels share.
const ORBIT: &str = include_str!("../../shaders/shared/orbit.wgsl");

/// The kernel of largest Lyapunov exponents.
pub fn lyapunov(int64: bool) -> Shader {
    with_random_numbers("lyapunov", &[ORBIT, include_str!("../../shaders/lyapunov.wgsl")].join("\n"), int64)
}

/// The kernel of orbits strobed once per period.
pub fn poincare(int64: bool) -> Shader {
    with_random_numbers("poincare", &[ORBIT, include_str!("../../shaders/poincare.wgsl")].join("\n"), int64)
}

/// The kernel of misfits between models and a driven recording.
pub fn misfit() -> Shader {
    Shader { name: "misfit", text: include_str!("../../shaders/misfit.wgsl").to_owned() }
}

/// The reduction.
pub fn reduce() -> Shader {
    Shader { name: "reduce", text: [LAYOUT, include_str!("../../shaders/reduce.wgsl")].join("\n") }
}

/// Nothing but multiply-adds: the device's peak.
pub fn peak() -> Shader {
    Shader { name: "peak", text: include_str!("../../shaders/peak.wgsl").to_owned() }
}

/// A check of the device: what sums keep of a small number beside a large one.
pub fn compensation() -> Shader {
    Shader { name: "compensation", text: [ACCUMULATE, include_str!("../../shaders/compensation.wgsl")].join("\n") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::layout;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    fn parsed(shader: &Shader) -> naga::Module {
        let module = naga::front::wgsl::parse_str(&shader.text).map_err(|e| e.emit_to_string(&shader.text));
        let module = module.unwrap_or_else(|e| panic!("{}: {e}", shader.name));
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_INT64);
        validator.validate(&module).unwrap_or_else(|e| panic!("{}: {e:?}", shader.name));
        module
    }

    /// Span, and name and offset of each member, of a struct in a shader.
    fn structure(module: &naga::Module, name: &str) -> (u32, Vec<(String, u32)>) {
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
        match &found.expect("the struct is there").1.inner {
            naga::TypeInner::Struct { members, span } => {
                (*span, members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect())
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn shaders_parse_and_validate() {
        let orbits = [lyapunov(false), lyapunov(true), poincare(false), poincare(true)];
        let others = [simulate(false), simulate(true), reduce(), compensation(), peak(), misfit()];
        others.iter().chain(&orbits).for_each(|s| drop(parsed(s)));
    }

    #[test]
    fn layouts_agree_with_their_mirrors() {
        let module = parsed(&simulate(false));
        for mirror in layout::mirrors() {
            let (span, members) = structure(&module, mirror.name);
            assert_eq!(span, mirror.size, "{}", mirror.name);
            let members: Vec<(&str, u32)> = members.iter().map(|(n, o)| (n.as_str(), *o)).collect();
            assert_eq!(members, mirror.members, "{}", mirror.name);
        }
    }

    #[test]
    fn the_map_kernels_agree_with_their_mirror_and_bindings() {
        for (shader, bindings) in [(lyapunov(false), 4), (poincare(false), 5)] {
            let module = parsed(&shader);
            let (span, members) = structure(&module, "OrbitTile");
            assert_eq!(span as usize, size_of::<layout::OrbitTile>());
            let offset = |name: &str| members.iter().find(|m| m.0 == name).map(|m| m.1 as usize);
            assert_eq!(offset("points"), Some(std::mem::offset_of!(layout::OrbitTile, points)));
            assert_eq!(offset("strobe"), Some(std::mem::offset_of!(layout::OrbitTile, strobe)));
            let found = module.global_variables.iter().filter(|(_, v)| v.binding.is_some()).count();
            assert_eq!(found, bindings, "{}", shader.name);
            assert_eq!(module.entry_points[0].workgroup_size, [layout::ORBIT_WORKGROUP, 1, 1]);
        }
    }

    #[test]
    fn the_misfit_kernel_agrees_with_its_mirror_columns_and_bindings() {
        use crate::kernel::misfit as contract;
        use std::mem::offset_of;
        let (shader, tile) = (misfit(), |offset: usize| offset as u32);
        let module = parsed(&shader);
        let (span, members) = structure(&module, "MisfitTile");
        assert_eq!(span as usize, size_of::<layout::MisfitTile>());
        let expected = [
            ("points", tile(offset_of!(layout::MisfitTile, points))),
            ("run", tile(offset_of!(layout::MisfitTile, run))),
            ("first", tile(offset_of!(layout::MisfitTile, first))),
            ("samples", tile(offset_of!(layout::MisfitTile, samples))),
            ("block", tile(offset_of!(layout::MisfitTile, block))),
            ("blocks", tile(offset_of!(layout::MisfitTile, blocks))),
            ("last", tile(offset_of!(layout::MisfitTile, last))),
            ("grid_end", tile(offset_of!(layout::MisfitTile, grid_end))),
        ];
        assert_eq!(members, expected.map(|(n, o)| (n.to_owned(), o)));
        assert_eq!(module.global_variables.iter().filter(|(_, v)| v.binding.is_some()).count(), 6);
        assert_eq!(module.entry_points[0].workgroup_size, [layout::MISFIT_WORKGROUP, 1, 1]);
        for (name, place) in contract::COLUMN_NAMES {
            assert!(shader.text.contains(&format!("const {name} = {place}u;\n")), "{name}");
        }
        assert!(shader.text.contains(&format!("const MOST_DIRECTIONS = {}u;", contract::MOST_DIRECTIONS)));
        assert!(shader.text.contains("const LOST = 1e6;") && contract::LOST == 1e6);
        // Every part that the host switches on is an override of the shader.
        for (name, _) in contract::Parts::default().constants() {
            assert!(module.overrides.iter().any(|(_, o)| o.name.as_deref() == Some(name)), "{name}");
        }
    }

    #[test]
    fn a_shifted_member_is_noticed() {
        let moved = simulate(false).text.replacen("stride: u32,", "", 1);
        let module = parsed(&Shader { name: "moved", text: moved.replace("tile.stride", "tile.members") });
        assert_ne!(structure(&module, "Tile").1, layout::mirrors()[0].members_owned());
    }

    #[test]
    fn bindings_and_workgroups_are_what_the_host_dispatches() {
        for (shader, bindings, size) in
            [(simulate(false), layout::SIMULATE_BINDINGS, layout::SIMULATE_WORKGROUP), (reduce(), 5, 256)]
        {
            let module = parsed(&shader);
            let mut found: Vec<u32> =
                module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| b.binding)).collect();
            found.sort_unstable();
            assert_eq!(found, (0..bindings).collect::<Vec<u32>>(), "{}", shader.name);
            let entry = &module.entry_points[0];
            assert_eq!((entry.name.as_str(), entry.workgroup_size), (shader.name, [size, 1, 1]));
        }
    }

    #[test]
    fn columns_and_bounds_agree() {
        let constants = |name: &str| format!("const {name} = ");
        for (name, place) in layout::COLUMN_NAMES {
            let line = LAYOUT.lines().find(|l| l.starts_with(&constants(name)));
            assert_eq!(line, Some(format!("const {name} = {place}u;").as_str()));
        }
        assert!(LAYOUT.contains("const BOUND_M_S2 = 1e7;"));
        assert_eq!(crate::kernel::cpu::sums::BOUND_M_S2, 1e7);
    }
}
