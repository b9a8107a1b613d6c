//! Kernels compiled for several instruction sets, chosen when the program runs.
//!
//! A kernel is plain Rust over arrays of [`LANES`] numbers. The compiler turns it into vector
//! instructions of the set for which it is compiled. As every fused multiplication is written as
//! `mul_add` and no sum is reordered, all versions give the same bytes.

/// Numbers per lane array: a full vector of AVX-512, two of AVX2.
pub(crate) const LANES: usize = 8;

/// One number per lane.
pub(crate) type Lanes = [f64; LANES];

/// An instruction set of this processor; a value exists only if the set was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InstructionSet(Kind);

/// Names of instruction sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The instructions that the target guarantees; `mul_add` may be a slow function call.
    Portable,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 Foundation.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// All sets that this processor supports, the best one last.
    pub(crate) fn available() -> impl DoubleEndedIterator<Item = Self> {
        let kinds: &[Kind] = &[
            Kind::Portable,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512,
        ];
        kinds
            .iter()
            .filter(|kind| kind.is_available())
            .copied()
            .map(Self)
    }

    /// The best set that this processor supports.
    pub(crate) fn best() -> Self {
        Self::available()
            .next_back()
            .expect("the portable set is always there")
    }

    /// The best set whose registers hold at most `lanes` numbers. With wider registers, kernels
    /// over shorter arrays lose more in shuffles than they gain.
    pub(crate) fn best_of_width(lanes: usize) -> Self {
        Self::available()
            .rfind(|set| set.0.register_width() <= lanes)
            .unwrap_or(Self(Kind::Portable))
    }

    /// The instruction set.
    pub(crate) fn kind(self) -> Kind {
        self.0
    }
}

impl Kind {
    /// Numbers per register.
    fn register_width(self) -> usize {
        match self {
            Self::Portable => 2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => 4,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => 8,
        }
    }

    fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Self::Avx2.is_available() && is_x86_feature_detected!("avx512f"),
        }
    }
}

/// Defines a function that takes an [`InstructionSet`] and then the arguments of the kernel, and runs
/// the kernel compiled for that set.
macro_rules! kernel {
    ($(#[$meta:meta])* fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(unsafe_code)]
        pub(crate) fn $name(
            set: $crate::linalg::instruction_set::InstructionSet,
            $($argument: $kind),*
        ) $(-> $result)? {
            use $crate::linalg::instruction_set::Kind;
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
                // SAFETY: an `InstructionSet` of this kind exists only if it was detected.
                #[cfg(target_arch = "x86_64")]
                Kind::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                Kind::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}
pub(crate) use kernel;
