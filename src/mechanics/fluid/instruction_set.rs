//! Kernels compiled for several instruction sets, chosen when the program runs.
//!
//! A kernel is plain Rust over arrays of [`LANES`] numbers. The compiler turns it into vector
//! instructions of whatever set it is compiled for. As every fused multiplication is written as
//! `mul_add` and no sum is reordered, all versions give the same bytes.

/// Numbers per lane array: a full vector of AVX-512, two of AVX2.
pub(super) const LANES: usize = 8;

/// One number per lane.
pub(super) type Lanes = [f64; LANES];

/// An instruction set that this processor has; a value exists only where it was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InstructionSet(Kind);

/// Names of instruction sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whatever the target guarantees; `mul_add` may be a slow function call.
    Portable,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 Foundation.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// All sets that this processor has, the best one last.
    pub fn available() -> Vec<Self> {
        let mut sets = vec![Self(Kind::Portable)];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            sets.push(Self(Kind::Avx2));
            if is_x86_feature_detected!("avx512f") {
                sets.push(Self(Kind::Avx512));
            }
        }
        sets
    }

    /// Which set it is.
    pub fn kind(self) -> Kind {
        self.0
    }

    /// The best set that this processor has.
    pub fn best() -> Self {
        *Self::available()
            .last()
            .expect("the portable set is always there")
    }
}

/// Defines a function that takes an [`InstructionSet`] and then the arguments of the kernel, and runs
/// the kernel compiled for that set.
macro_rules! kernel {
    ($(#[$meta:meta])* fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(unsafe_code)]
        pub(super) fn $name(
            set: $crate::mechanics::fluid::instruction_set::InstructionSet,
            $($argument: $kind),*
        ) $(-> $result)? {
            use $crate::mechanics::fluid::instruction_set::Kind;
            #[inline(always)]
            fn portable($($argument: $kind),*) $(-> $result)? $body
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $kind),*) $(-> $result)? {
                portable($($argument),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx2,fma")]
            fn avx512($($argument: $kind),*) $(-> $result)? {
                portable($($argument),*)
            }
            match set.kind() {
                Kind::Portable => portable($($argument),*),
                // SAFETY: an `InstructionSet` of this kind exists only where it was detected.
                #[cfg(target_arch = "x86_64")]
                Kind::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                Kind::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}
pub(super) use kernel;
