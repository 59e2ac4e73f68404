//! Vector instructions without intrinsics: a kernel is written once over arrays of 64 lanes,
//! compiled for three instruction sets, and the best that the machine has is called.
//!
//! Trap that this file exists to avoid: `mul_add` without the fma feature is a library call, thirty
//! times slower. Hence the constant `FMA`. With and without, results differ in the last bit;
//! AVX-512 and AVX2 agree bit for bit.

use std::ops::{Index, IndexMut};
use std::sync::OnceLock;

/// Members side by side. Sixteen would wait for each other's latency; sixty-four hide it.
pub const LANES: usize = 64;

/// One number per member, on a cache line boundary: a vector register that straddles two lines
/// loads at half the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Lane<T>(pub [T; LANES]);

impl<T: Copy> Lane<T> {
    /// The same number for all.
    #[inline(always)]
    pub fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T> Index<usize> for Lane<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, lane: usize) -> &T {
        &self.0[lane]
    }
}

impl<T> IndexMut<usize> for Lane<T> {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut T {
        &mut self.0[lane]
    }
}

/// Work that can be compiled for several instruction sets. Mark `run` and all that it calls
/// `#[inline(always)]`.
pub trait Kernel {
    /// Result of the work.
    type Output;
    /// Does the work with or without fused multiply-add.
    fn run<const FMA: bool>(self) -> Self::Output;
}

/// Instruction sets that a kernel is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Instructions that every machine of this architecture has (on aarch64: NEON, with fused
    /// multiply-add).
    Baseline,
    /// AVX2 with fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 (F, BW, CD, DQ, VL).
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// The best that this machine has.
    pub fn best() -> Self {
        static BEST: OnceLock<Level> = OnceLock::new();
        *BEST.get_or_init(|| *Self::available().last().unwrap_or(&Self::Baseline))
    }

    /// All that this machine has, worst first.
    pub fn available() -> Vec<Self> {
        #[allow(unused_mut)]
        let mut levels = vec![Self::Baseline];
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            if has_avx2 {
                levels.push(Self::Avx2);
            }
            if has_avx2
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512cd")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                levels.push(Self::Avx512);
            }
        }
        levels
    }

    /// Returns whether multiply and add are fused.
    pub fn fused(self) -> bool {
        self != Self::Baseline || cfg!(target_arch = "aarch64")
    }

    /// Name for the provenance of a result.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline if cfg!(target_arch = "aarch64") => "NEON",
            Self::Baseline if cfg!(target_arch = "x86_64") => "SSE2",
            Self::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "AVX2 + FMA",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "AVX-512",
        }
    }

    /// Runs a kernel compiled for this level, or for the best that the machine has if it lacks this
    /// one.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // Levels are nested and in order: what is not above the best is there.
        match self.min(Self::best()) {
            Self::Baseline => kernel.run::<{ cfg!(target_arch = "aarch64") }>(),
            // SAFETY: `available` lists a level only where all of its features were detected, and
            // the best is the last.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<true>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma")]
fn avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<true>()
}
