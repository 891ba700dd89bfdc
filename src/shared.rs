//! Declarations that Rust and the shaders share: constants, numbered choices, and structs of buffers.
//!
//! Each is declared once, in Rust, by the module that owns it, with [`shared!`](crate::shared!). The
//! shader's side is generated: `shared! { in probes; … }` adds to the shader module
//! `package::generated::probes`, which every [`ShaderLibrary`](crate::gpu::ShaderLibrary) contains.
//! Facts that only shaders know are declared in `shaders/`.
//!
//! This module is a leaf: worlds, lights and probes declare their shared items here too, and know no
//! GPU.

use std::{collections::BTreeMap, fmt::Write as _};

use glam::{DMat3, DVec3};

#[doc(hidden)]
pub use inventory;

/// A declaration shared with shaders.
pub struct Declaration {
    /// Name of the generated module.
    pub module: &'static str,
    /// Its name in shaders.
    pub name: &'static str,
    /// Its WGSL text.
    pub text: fn() -> String,
    /// Layout of a struct.
    pub layout: Option<fn() -> Layout>,
}

/// Memory layout of a shared struct in Rust.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Offset of each member by name, without padding.
    pub members: BTreeMap<String, usize>,
    /// Bytes from one array element to the next.
    pub stride: usize,
}

inventory::collect!(Declaration);

/// Every declaration, sorted by module and name, because the linker's order is arbitrary.
pub fn declarations() -> Vec<&'static Declaration> {
    let mut all: Vec<_> = inventory::iter::<Declaration>.into_iter().collect();
    all.sort_by_key(|declaration| (declaration.module, declaration.name));
    all
}

/// The text of each generated module, by its name.
pub fn modules() -> BTreeMap<&'static str, String> {
    let mut modules = BTreeMap::<_, String>::new();
    for declaration in declarations() {
        let text = modules
            .entry(declaration.module)
            .or_insert_with(|| "// Generated from Rust: see src/shared.rs.\n".to_owned());
        write!(text, "\n{}", (declaration.text)()).expect("writing to a string");
    }
    modules
}

/// A type with a counterpart in WGSL.
pub trait ShaderType {
    /// Its WGSL name.
    fn name() -> String;

    /// WGSL name of an array of `count` elements.
    fn array(count: usize) -> String {
        format!("array<{}, {count}>", Self::name())
    }
}

/// A value for a constant in WGSL.
pub trait ShaderValue: ShaderType {
    /// Its WGSL literal.
    fn literal(&self) -> String;
}

/// Scalars, and their vectors of two to four.
macro_rules! scalar {
    ($($rust:ty, $wgsl:literal, $suffix:literal, $value:ident => $literal:expr;)*) => {
        $(impl ShaderType for $rust {
            fn name() -> String {
                $wgsl.to_owned()
            }

            fn array(count: usize) -> String {
                match count {
                    2..=4 => format!("vec{count}{}", $suffix),
                    _ => format!("array<{}, {count}>", $wgsl),
                }
            }
        }

        impl ShaderValue for $rust {
            fn literal(&self) -> String {
                let $value = *self;
                $literal
            }
        })*
    };
}

// Floats are written with the fewest digits that give the same bits back.
scalar! {
    // Large values in hexadecimal.
    u32, "u32", "u", value => if value > 0xffff { format!("{value:#x}u") } else { format!("{value}u") };
    i32, "i32", "i", value => format!("{value}i");
    f32, "f32", "f", value => format!("{value:?}");
    // Constants that the CPU needs with more digits.
    f64, "f32", "f", value => format!("{:?}", value as f32);
    u64, "u32", "u", value => format!("{value}u");
    usize, "u32", "u", value => format!("{value}u");
}

impl<T: ShaderType, const COUNT: usize> ShaderType for [T; COUNT] {
    fn name() -> String {
        T::array(COUNT)
    }
}

impl<T: ShaderValue, const COUNT: usize> ShaderValue for [T; COUNT] {
    fn literal(&self) -> String {
        let parts: Vec<_> = self.iter().map(T::literal).collect();
        format!("{}({})", Self::name(), parts.join(", "))
    }
}

impl ShaderType for DVec3 {
    fn name() -> String {
        f64::array(3)
    }
}

impl ShaderValue for DVec3 {
    fn literal(&self) -> String {
        self.to_array().literal()
    }
}

impl ShaderType for DMat3 {
    fn name() -> String {
        "mat3x3f".to_owned()
    }
}

impl ShaderValue for DMat3 {
    fn literal(&self) -> String {
        let columns: Vec<_> = self
            .to_cols_array_2d()
            .iter()
            .map(<[f64; 3]>::literal)
            .collect();
        format!("mat3x3f({})", columns.join(", "))
    }
}

#[doc(hidden)]
pub fn constant<T: ShaderValue>(docs: &[&str], name: &str, value: &T) -> String {
    let (docs, ty) = (comment("", docs), T::name());
    format!("{docs}const {name}: {ty} = {};\n", value.literal())
}

/// One constant for each variant: `PREFIX_VARIANT`.
#[doc(hidden)]
pub fn choices(prefix: &str, variants: &[(&str, u32)]) -> String {
    let constants = variants.iter().map(|(variant, value)| {
        let mut name = prefix.to_owned();
        for letter in variant.chars() {
            if letter.is_uppercase() {
                name.push('_');
            }
            name.extend(letter.to_uppercase());
        }
        format!("const {name}: u32 = {value}u;\n")
    });
    constants.collect()
}

/// `members`: comment, name and type of each.
#[doc(hidden)]
pub fn structure(docs: &[&str], name: &str, members: &[(&[&str], &str, String)]) -> String {
    let mut text = format!("{}struct {name} {{\n", comment("", docs));
    for (docs, member, ty) in members.iter().filter(|(_, member, _)| !is_padding(member)) {
        let docs = comment("    ", docs);
        writeln!(text, "{docs}    {member}: {ty},").expect("writing to a string");
    }
    text + "}\n"
}

#[doc(hidden)]
pub fn layout(members: &[(&str, usize)], stride: usize) -> Layout {
    let named = members.iter().filter(|(member, _)| !is_padding(member));
    Layout {
        members: named
            .map(|&(member, offset)| (member.to_owned(), offset))
            .collect(),
        stride,
    }
}

/// WGSL inserts such padding itself.
fn is_padding(member: &str) -> bool {
    member.starts_with('_')
}

fn comment(indent: &str, docs: &[&str]) -> String {
    let lines = docs.iter().flat_map(|doc| doc.lines());
    lines.map(|line| format!("{indent}//{line}\n")).collect()
}

/// Declares constants, choices and structs that Rust and shaders share. Doc comments are copied too.
///
/// ```text
/// shared! {
///     in probes;                                        // shaders: package::generated::probes
///
///     /// Threads of a workgroup.
///     pub const RAY_GROUP: u32 = 64;                    // const RAY_GROUP: u32 = 64u;
///
///     const SOLID as CELL_SOLID: u32 = 1 << 31;         // const CELL_SOLID: u32 = 2147483648u;
///
///     use 2 * RAY_GROUP => MOST_RAYS: u32;              // const MOST_RAYS: u32 = 128u; Rust has the value already
///
///     enum View as VIEW { Full, TexturesOff }           // const VIEW_TEXTURES_OFF: u32 = 1u; of a known enum
///
///     /// A struct that is `repr(C)` and plain data. Members that begin with `_` are padding.
///     pub struct GpuLamp as Lamp {
///         pub position_ws: [f32; 3],                    // position_ws: vec3f,
///         pub count: u32 => "atomic<u32>",              // count: atomic<u32>,
///     }
/// }
/// ```
#[macro_export]
macro_rules! shared {
    (in $module:ident;) => {};
    (
        in $module:ident;
        $(#[doc = $doc:literal])*
        use $value:expr => $wgsl:ident: $ty:ty;
        $($rest:tt)*
    ) => {
        $crate::shared! { @declare $module, stringify!($wgsl), None,
            || $crate::shared::constant::<$ty>(&[$($doc),*], stringify!($wgsl), &$value) }
        $crate::shared! { in $module; $($rest)* }
    };
    (
        in $module:ident;
        $(#[doc = $doc:literal])*
        $visible:vis const $name:ident: $ty:ty = $value:expr;
        $($rest:tt)*
    ) => {
        $crate::shared! {
            in $module;
            $(#[doc = $doc])*
            $visible const $name as $name: $ty = $value;
            $($rest)*
        }
    };
    (
        in $module:ident;
        $(#[doc = $doc:literal])*
        $visible:vis const $name:ident as $wgsl:ident: $ty:ty = $value:expr;
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        $visible const $name: $ty = $value;
        $crate::shared! { @declare $module, stringify!($wgsl), None,
            || $crate::shared::constant(&[$($doc),*], stringify!($wgsl), &$name) }
        $crate::shared! { in $module; $($rest)* }
    };
    (
        in $module:ident;
        enum $name:ident as $prefix:ident { $($variant:ident),* $(,)? }
        $($rest:tt)*
    ) => {
        $crate::shared! { @declare $module, stringify!($prefix), None, || {
            // Every variant is listed, or this does not compile.
            let value = |choice: $name| match choice { $($name::$variant => choice as u32),* };
            $crate::shared::choices(
                stringify!($prefix),
                &[$((stringify!($variant), value($name::$variant))),*],
            )
        } }
        $crate::shared! { in $module; $($rest)* }
    };
    (
        in $module:ident;
        $(#[doc = $doc:literal])*
        $visible:vis struct $name:ident as $wgsl:ident {
            $(
                $(#[doc = $member_doc:literal])*
                $member_visible:vis $member:ident: $ty:ty $(=> $wgsl_ty:literal)?
            ),* $(,)?
        }
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $visible struct $name {
            $($(#[doc = $member_doc])* $member_visible $member: $ty),*
        }

        impl $crate::shared::ShaderType for $name {
            fn name() -> String {
                stringify!($wgsl).to_owned()
            }
        }

        $crate::shared! { @declare $module, stringify!($wgsl),
            Some(|| $crate::shared::layout(
                &[$((stringify!($member), std::mem::offset_of!($name, $member))),*],
                size_of::<$name>(),
            )),
            || $crate::shared::structure(
                &[$($doc),*],
                stringify!($wgsl),
                &[$((
                    &[$($member_doc),*],
                    stringify!($member),
                    $crate::shared!(@type $ty $(, $wgsl_ty)?),
                )),*],
            ) }
        $crate::shared! { in $module; $($rest)* }
    };
    (@type $ty:ty) => { <$ty as $crate::shared::ShaderType>::name() };
    (@type $ty:ty, $wgsl_ty:literal) => { $wgsl_ty.to_owned() };
    (@declare $module:ident, $name:expr, $layout:expr, $text:expr) => {
        $crate::shared::inventory::submit! {
            $crate::shared::Declaration {
                module: stringify!($module),
                name: $name,
                text: $text,
                layout: $layout,
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::{Expression, Literal};

    #[derive(Clone, Copy)]
    enum Answer {
        No,
        NotYet,
    }

    crate::shared! {
        in test_of_shared;

        /// The first line.
        /// The second.
        const LARGE: u32 = 1 << 31;
        const TINY as SMALL: f32 = 1e-20;
        const THIRD: f64 = 1.0 / 3.0;
        use TINY * 2.0 => TWICE: f32;
        enum Answer as ANSWER { No, NotYet }

        /// A struct.
        struct GpuMixed as Mixed {
            /// A member.
            place: [f32; 3],
            count: u32 => "atomic<u32>",
            rows: [[i32; 4]; 2],
            inner: [GpuInner; 2],
            last: f32,
            _pad: [u32; 3],
        }

        struct GpuInner as Inner {
            words: [u32; 2],
        }
    }

    fn module() -> naga::Module {
        let text = &modules()["test_of_shared"];
        naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    #[test]
    fn constants_have_the_same_bits_on_both_sides() {
        let module = module();
        let value = |name: &str| {
            let mut constants = module.constants.iter();
            let (_, constant) = constants
                .find(|(_, constant)| constant.name.as_deref() == Some(name))
                .expect("it is declared");
            match module.global_expressions[constant.init] {
                Expression::Literal(Literal::U32(value)) => value,
                Expression::Literal(Literal::F32(value)) => value.to_bits(),
                ref other => panic!("{name}: {other:?}"),
            }
        };
        assert_eq!(value("LARGE"), LARGE);
        assert_eq!(value("SMALL"), TINY.to_bits());
        assert_eq!(value("THIRD"), (THIRD as f32).to_bits());
        assert_eq!(value("TWICE"), (TINY * 2.0).to_bits());
        assert_eq!(value("ANSWER_NO"), Answer::No as u32);
        assert_eq!(value("ANSWER_NOT_YET"), Answer::NotYet as u32);
    }

    #[test]
    fn comments_and_types_are_generated_too() {
        let text = &modules()["test_of_shared"];
        for part in [
            "// The first line.\n// The second.\nconst LARGE: u32 = 0x80000000u;\n",
            "// A struct.\nstruct Mixed {\n    // A member.\n    place: vec3f,\n    count: atomic<u32>,\n",
            "    rows: array<vec4i, 2>,\n    inner: array<Inner, 2>,\n    last: f32,\n}\n",
            "struct Inner {\n    words: vec2u,\n}\n",
        ] {
            assert!(text.contains(part), "{text}");
        }
        assert!(text.is_ascii() && !text.contains("_pad"), "{text}");
    }

    #[test]
    fn modules_are_the_same_in_every_run_and_declare_nothing_twice() {
        assert_eq!(modules(), modules());
        let names: Vec<_> = declarations()
            .iter()
            .map(|declared| (declared.module, declared.name))
            .collect();
        assert!(names.is_sorted_by(|a, b| a < b), "{names:?}");
    }
}
