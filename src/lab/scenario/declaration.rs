//! One declaration for each key of a table: its description, form, range and default.
//!
//! From a declaration [`keys!`] generates the typed table (with its JSON Schema, which has unit,
//! range and default of each key), the resolved table, and the conversion between them. A line
//! declares a key, its [form](super::form), and whether it is required:
//!
//! | line ends with | where the key is missing | value |
//! |---|---|---|
//! | `required` | a fault | `V` |
//! | `optional` | nothing | `Option<V>` |
//! | `default(value)` | the value, which the schema names | `V` |
//! | `derived(value)` | the value, which depends on parameters of the table and keys above | `V` |
//! | `raw` | typed only: a function beside the declaration checks it | |
//!
//! `table Typed "name" => Resolved(parameters) { keys }` declares a table.
//! `kinds Typed "name", "case" => Resolved { Kind { keys }, ... }` declares a table whose keys
//! depend on its `kind`. Keys common to all kinds precede and follow the kinds; those of the block
//! `also` belong only to the kinds marked `also`. A table without `=> Resolved` gets a method for
//! each key instead. Functions next to the declaration call these methods to build the resolved
//! value and to check keys against each other.

macro_rules! keys {
    // A table whose keys are resolved one by one.
    (
        $(#[$about:meta])*
        table $Typed:ident $schema:literal => $(#[$derive:meta])* $Resolved:ident ($($parameter:ident: $Parameter:ty),*) {
            $($(#[$doc:meta])* $key:ident: $form:ident $args:tt $presence:ident $(($default:expr))?),* $(,)?
        }
    ) => {
        keys! { @struct $(#[$about])* $Typed $schema { $($(#[$doc])* $key: $form $args $presence $(($default))?),* } }

        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        $(#[$derive])*
        pub struct $Resolved {
            $($(#[$doc])* #[doc = keys!(@quantity $form $args)] pub $key: keys!(@value $form $args $presence),)*
        }

        impl $Typed {
            /// Resolves the table.
            pub fn resolve(&self, section: &$crate::scenario::section::Section<'_>, $($parameter: $Parameter),*) -> $Resolved {
                $(let $key = keys!(@resolve section $key (&self.$key) $form $args $presence $(($default))?);)*
                $Resolved { $($key),* }
            }
        }
    };
    // A table that functions next to the declaration resolve.
    (
        $(#[$about:meta])*
        table $Typed:ident $schema:literal {
            $($(#[$doc:meta])* $key:ident: $form:ident $args:tt $presence:ident $(($default:expr))?),* $(,)?
        }
    ) => {
        keys! { @struct $(#[$about])* $Typed $schema { $($(#[$doc])* $key: $form $args $presence $(($default))?),* } }

        impl $Typed {
            $(keys! { @method $(#[$doc])* $key $form $args $presence $(($default))? })*
        }
    };
    // A table of several kinds.
    (
        $(#[$about:meta])*
        kinds $Typed:ident $schema:literal, $case:literal => $(#[$derive:meta])* $Resolved:ident {
            $($(#[$kind_doc:meta])* $Kind:ident $({
                $($(#[$doc:meta])* $key:ident: $form:ident $args:tt $presence:ident $(($default:expr))?),* $(,)?
            })?),* $(,)?
        }
    ) => {
        $(#[$about])*
        #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
        #[serde(rename_all = $case)]
        #[schemars(tag = "kind", deny_unknown_fields, rename = $schema)]
        pub enum $Typed {
            $($(#[$kind_doc])* $Kind {
                $($(
                    $(#[$doc])*
                    #[schemars(transform = keys!(@note $form $args $presence $(($default))?))]
                    $key: Option<keys!(@typed $form $args)>,
                )*)?
            },)*
        }

        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        #[serde(tag = "kind", rename_all = $case)]
        $(#[$derive])*
        pub enum $Resolved {
            $($(#[$kind_doc])* $Kind $({
                $($(#[$doc])* #[doc = keys!(@quantity $form $args)] $key: keys!(@value $form $args $presence),)*
            })?,)*
        }

        impl $Typed {
            /// Resolves the table.
            pub fn resolve(&self, section: &$crate::scenario::section::Section<'_>) -> $Resolved {
                match self {
                    $(Self::$Kind { $($($key),*)? } => {
                        $($(let $key = keys!(@resolve section $key ($key) $form $args $presence $(($default))?);)*)?
                        $Resolved::$Kind $({ $($key),* })?
                    })*
                }
            }
        }
    };

    // A table of several kinds with common keys, which are first added to each kind.
    (
        $(#[$about:meta])*
        kinds $Typed:ident $schema:literal, $case:literal => $(#[$derive:meta])* $Resolved:ident $parameters:tt
        before { $($before:tt)* }
        also { $($also:tt)* }
        $(#[$kind_derive:meta])* $Kind:ident { $($kinds:tt)* }
        after { $($after:tt)* }
    ) => {
        keys! {
            @spread
            [{ $(#[$about])* $Typed $schema $case $(#[$derive])* $Resolved $parameters $(#[$kind_derive])* $Kind } { $($before)* } { $($also)* } { $($after)* }]
            []
            $($kinds)*
        }
    };
    (@spread [$head:tt { $($before:tt)* } { $($also:tt)* } $after:tt] [$($done:tt)*]
        $(#[$doc:meta])* $Name:ident also $({ $($own:tt)* })? $(, $($rest:tt)*)?
    ) => {
        keys! {
            @spread [$head { $($before)* } { $($also)* } $after]
            [$($done)* $(#[$doc])* $Name [{ $($before)* $($also)* } {} $after $({ $($own)* })?]]
            $($($rest)*)?
        }
    };
    (@spread [$head:tt $before:tt $also:tt $after:tt] [$($done:tt)*]
        $(#[$doc:meta])* $Name:ident $({ $($own:tt)* })? $(, $($rest:tt)*)?
    ) => {
        keys! {
            @spread [$head $before $also $after]
            [$($done)* $(#[$doc])* $Name [$before $also $after $({ $($own)* })?]]
            $($($rest)*)?
        }
    };
    (@spread
        [
            { $(#[$about:meta])* $Typed:ident $schema:literal $case:literal $(#[$derive:meta])* $Resolved:ident ($($parameter:ident: $Parameter:ty),*) $(#[$kind_derive:meta])* $Kind:ident }
            { $($(#[$b_doc:meta])* $b_key:ident: $b_form:ident $b_args:tt $b_presence:ident $(($b_default:expr))?),* $(,)? }
            { $($(#[$s_doc:meta])* $s_key:ident: $s_form:ident $s_args:tt $s_presence:ident $(($s_default:expr))?),* $(,)? }
            { $($(#[$e_doc:meta])* $e_key:ident: $e_form:ident $e_args:tt $e_presence:ident $(($e_default:expr))?),* $(,)? }
        ]
        [$($(#[$kind_doc:meta])* $Name:ident [
            { $($(#[$c_doc:meta])* $c_key:ident: $c_form:ident $c_args:tt $c_presence:ident $(($c_default:expr))?),* $(,)? }
            { $($(#[$n_doc:meta])* $n_key:ident: $n_form:ident $n_args:tt $n_presence:ident $(($n_default:expr))?),* $(,)? }
            { $($(#[$a_doc:meta])* $a_key:ident: $a_form:ident $a_args:tt $a_presence:ident $(($a_default:expr))?),* $(,)? }
            $({ $($(#[$doc:meta])* $key:ident: $form:ident $args:tt $presence:ident $(($default:expr))?),* $(,)? })?
        ])*]
    ) => {
        $(#[$about])*
        #[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
        #[serde(rename_all = $case)]
        #[schemars(tag = "kind", deny_unknown_fields, rename = $schema)]
        pub enum $Typed {
            $($(#[$kind_doc])* $Name {
                $(
                    $(#[$c_doc])*
                    #[schemars(transform = keys!(@note $c_form $c_args $c_presence $(($c_default))?))]
                    $c_key: Option<keys!(@typed $c_form $c_args)>,
                )*
                $($(
                    $(#[$doc])*
                    #[schemars(transform = keys!(@note $form $args $presence $(($default))?))]
                    $key: Option<keys!(@typed $form $args)>,
                )*)?
                $(
                    $(#[$a_doc])*
                    #[schemars(transform = keys!(@note $a_form $a_args $a_presence $(($a_default))?))]
                    $a_key: Option<keys!(@typed $a_form $a_args)>,
                )*
            },)*
        }

        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        $(#[$derive])*
        pub struct $Resolved {
            $($(#[$b_doc])* #[doc = keys!(@quantity $b_form $b_args)] pub $b_key: keys!(@value $b_form $b_args $b_presence),)*
            $($(#[$s_doc])* #[doc = keys!(@quantity $s_form $s_args)] pub $s_key: keys!(@value $s_form $s_args $s_presence),)*
            /// Kind of the table, with the keys that depend on it.
            #[serde(flatten)]
            pub kind: $Kind,
            $($(#[$e_doc])* #[doc = keys!(@quantity $e_form $e_args)] pub $e_key: keys!(@value $e_form $e_args $e_presence),)*
        }

        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        #[serde(tag = "kind", rename_all = $case)]
        $(#[$kind_derive])*
        pub enum $Kind {
            $($(#[$kind_doc])* $Name $({
                $($(#[$doc])* #[doc = keys!(@quantity $form $args)] $key: keys!(@value $form $args $presence),)*
            })?,)*
        }

        impl $Typed {
            /// Resolves the table.
            pub fn resolve(&self, section: &$crate::scenario::section::Section<'_>, $($parameter: $Parameter),*) -> $Resolved {
                match self {
                    $(Self::$Name { $($c_key,)* $($($key,)*)? $($a_key,)* } => {
                        $($(let $key = keys!(@resolve section $key ($key) $form $args $presence $(($default))?);)*)?
                        let kind = $Kind::$Name $({ $($key),* })?;
                        $(let $c_key = keys!(@resolve section $c_key ($c_key) $c_form $c_args $c_presence $(($c_default))?);)*
                        $(let $a_key = keys!(@resolve section $a_key ($a_key) $a_form $a_args $a_presence $(($a_default))?);)*
                        $Resolved { $($c_key,)* $($n_key: None,)* kind, $($a_key,)* }
                    })*
                }
            }
        }
    };

    // The struct of a table as typed.
    (@struct $(#[$about:meta])* $Typed:ident $schema:literal {
        $($(#[$doc:meta])* $key:ident: $form:ident $args:tt $presence:ident $(($default:expr))?),*
    }) => {
        $(#[$about])*
        #[derive(Debug, Default, serde::Deserialize, schemars::JsonSchema)]
        #[schemars(deny_unknown_fields, rename = $schema)]
        pub struct $Typed {
            $(
                $(#[$doc])*
                #[schemars(transform = keys!(@note $form $args $presence $(($default))?))]
                pub $key: keys!(@field $form $args),
            )*
        }
    };

    // The method of a key.
    (@method $(#[$doc:meta])* $key:ident $form:ident $args:tt raw) => {};
    (@method $(#[$doc:meta])* $key:ident $form:ident $args:tt derived) => {
        $(#[$doc])*
        pub fn $key(&self, section: &$crate::scenario::section::Section<'_>, default: keys!(@value $form $args derived)) -> keys!(@value $form $args derived) {
            keys!(@resolve section $key (&self.$key) $form $args derived (default))
        }
    };
    (@method $(#[$doc:meta])* $key:ident $form:ident $args:tt $presence:ident $(($default:expr))?) => {
        $(#[$doc])*
        pub fn $key(&self, section: &$crate::scenario::section::Section<'_>) -> keys!(@value $form $args $presence) {
            keys!(@resolve section $key (&self.$key) $form $args $presence $(($default))?)
        }
    };

    // The value of a key.
    (@resolve $section:ident $key:ident ($typed:expr) $form:ident $args:tt optional) => {
        $crate::scenario::form::Form::optional(&keys!(@form $form $args), $section, stringify!($key), $typed)
    };
    (@resolve $section:ident $key:ident ($typed:expr) $form:ident $args:tt required) => {
        $crate::scenario::form::Requirable::required(&keys!(@form $form $args), $section, stringify!($key), $typed)
    };
    (@resolve $section:ident $key:ident ($typed:expr) $form:ident $args:tt $presence:ident ($default:expr)) => {
        $crate::scenario::form::Form::optional(&keys!(@form $form $args), $section, stringify!($key), $typed).unwrap_or_else(|| $default)
    };

    // The entries of a key in the schema.
    (@note $form:ident $args:tt raw) => { $crate::scenario::form::Note::default() };
    (@note $form:ident $args:tt required) => { $crate::scenario::form::Note::of(&keys!(@form $form $args)).required() };
    (@note $form:ident $args:tt default ($default:expr)) => {
        $crate::scenario::form::Note::of(&keys!(@form $form $args)).with_default(&$default)
    };
    (@note $form:ident $args:tt $presence:ident $(($default:expr))?) => { $crate::scenario::form::Note::of(&keys!(@form $form $args)) };

    // The type of a value.
    (@value $form:ident $args:tt optional) => { Option<keys!(@value $form $args)> };
    (@value $form:ident $args:tt $presence:ident) => { keys!(@value $form $args) };

    // The type of a field of the typed table.
    (@field tables($T:ty)) => { $T };
    (@field $form:ident $args:tt) => { Option<keys!(@typed $form $args)> };

    // Forms: typed value, resolved value, and checks.
    (@typed number($D:ty, $range:expr)) => { $crate::scenario::quantity::Quantity<$D> };
    (@typed numbers($D:ty, $n:literal, $range:expr)) => { [$crate::scenario::quantity::Quantity<$D>; $n] };
    (@typed vector($D:ty $(, $range:expr)?)) => { $crate::scenario::quantity::Vector<$D> };
    (@typed direction()) => { $crate::scenario::quantity::Vector<$crate::scenario::units::Dimensionless> };
    (@typed corners($D:ty)) => { Vec<($crate::scenario::quantity::Quantity<$crate::scenario::units::Time>, $crate::scenario::quantity::Quantity<$D>)> };
    (@typed rows($X:ty, $Y:ty)) => { Vec<($crate::scenario::quantity::Quantity<$X>, $crate::scenario::quantity::Quantity<$Y>)> };
    (@typed count($range:expr)) => { i64 };
    (@typed index()) => { i64 };
    (@typed place()) => { $crate::scenario::place::TypedPlace };
    (@typed places($help:expr)) => { [$crate::scenario::place::TypedPlace; 2] };
    (@typed column()) => { String };
    (@typed text($($help:expr)?)) => { String };
    (@typed flag()) => { bool };
    (@typed word($T:ty $(, $help:expr)?)) => { $T };
    (@typed table($Typed:ident => $Resolved:ty)) => { $Typed };
    (@typed raw($T:ty)) => { $T };

    (@value number $args:tt) => { f64 };
    (@value numbers($D:ty, $n:literal, $range:expr)) => { [f64; $n] };
    (@value vector $args:tt) => { [f64; 3] };
    (@value direction $args:tt) => { [f64; 3] };
    (@value corners $args:tt) => { Vec<(f64, f64)> };
    (@value rows $args:tt) => { Vec<(f64, f64)> };
    (@value count $args:tt) => { usize };
    (@value index $args:tt) => { usize };
    (@value place $args:tt) => { $crate::scenario::place::Place };
    (@value places $args:tt) => { [$crate::scenario::place::Place; 2] };
    (@value column $args:tt) => { String };
    (@value text $args:tt) => { String };
    (@value flag $args:tt) => { bool };
    (@value word($T:ty $(, $help:expr)?)) => { $T };
    (@value table($Typed:ident => $Resolved:ty)) => { $Resolved };

    (@form number($D:ty, $range:expr)) => { $crate::scenario::form::Number::<$D>::new($range) };
    (@form numbers($D:ty, $n:literal, $range:expr)) => { $crate::scenario::form::Numbers::<$D, $n>::new($range) };
    (@form vector($D:ty)) => { keys!(@form vector($D, $crate::scenario::section::FINITE)) };
    (@form vector($D:ty, $range:expr)) => { $crate::scenario::form::Numbers::<$D, 3>::new($range) };
    (@form direction()) => { $crate::scenario::form::Direction };
    (@form corners($D:ty)) => { $crate::scenario::form::Corners::<$D>::any() };
    (@form rows($X:ty, $Y:ty)) => { $crate::scenario::rows::Rows::<$X, $Y>::any() };
    (@form count($range:expr)) => { $crate::scenario::form::Count($range) };
    (@form index()) => { $crate::scenario::form::Index };
    (@form place()) => { $crate::scenario::form::Along };
    (@form places($help:expr)) => { $crate::scenario::form::AlongBoth($help) };
    (@form column()) => { $crate::scenario::form::ColumnName };
    (@form text()) => { $crate::scenario::form::Plain::<String>::new("text") };
    (@form text($help:expr)) => { $crate::scenario::form::Plain::<String>::new($help) };
    (@form flag()) => { $crate::scenario::form::Plain::<bool>::new("true or false") };
    (@form word($T:ty, $help:expr)) => { $crate::scenario::form::Plain::<$T>::new($help) };
    (@form word($T:ty)) => { $crate::scenario::form::Plain::<$T>::new("a word") };
    (@form table($Typed:ident => $Resolved:ty)) => { $crate::scenario::form::Nested($Typed::resolve) };

    // The quantity of a value, for the documentation.
    (@quantity number($D:ty, $range:expr)) => { concat!("\n\nQuantity: `", stringify!($D), "`, in SI units.") };
    (@quantity numbers($D:ty, $n:literal, $range:expr)) => { concat!("\n\nQuantity: `", stringify!($D), "`, in SI units.") };
    (@quantity vector($D:ty $(, $range:expr)?)) => { concat!("\n\nQuantity: `", stringify!($D), "`, in SI units.") };
    (@quantity corners($D:ty)) => { concat!("\n\nQuantity over time: `", stringify!($D), "`, in SI units.") };
    (@quantity rows($X:ty, $Y:ty)) => { concat!("\n\nQuantities: `", stringify!($X), "`, `", stringify!($Y), "`, in SI units.") };
    (@quantity direction()) => { "\n\nA unit vector." };
    (@quantity $form:ident $args:tt) => { "" };
}

pub(crate) use keys;
