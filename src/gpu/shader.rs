//! Shader composition. The only file that knows that WESL does it.

use std::{borrow::Cow, collections::BTreeMap, fs, path::Path};

use wesl::{
    CompileOptions, Mangler, ModulePath, ResolveError, Resolver,
    syntax::{Declaration, Function, GlobalDeclaration, Struct, TranslationUnit, TypeAlias},
};

use super::GpuError;
use crate::shared;

const EMBEDDED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The text of every shader module, by its name (`view/shade`): embedded in the binary, or read from a
/// folder at one moment. The generated modules (`generated/probes`, see [`crate::shared!`]) always come
/// from the binary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderLibrary {
    modules: BTreeMap<String, Cow<'static, str>>,
}

/// A complete shader: plain WGSL, and the naga module parsed from it.
pub struct Composed {
    pub name: String,
    pub wgsl: String,
    pub module: naga::Module,
    pub info: naga::valid::ModuleInfo,
    /// Sorted names of the modules that it contains, including those generated at run time.
    pub sources: Vec<String>,
}

impl ShaderLibrary {
    /// The modules embedded in the binary.
    pub fn embedded() -> Self {
        let modules = EMBEDDED
            .iter()
            .map(|&(name, text)| (name.to_owned(), text.into()));
        Self::with_generated(modules.collect())
    }

    /// The current content of `folder`. Later edits do not show: the library stays consistent.
    ///
    /// # Errors
    /// [`GpuError::Shader`] for a file that cannot be read, and for a folder without any shader.
    pub fn from_folder(folder: &Path) -> Result<Self, GpuError> {
        let mut modules = BTreeMap::new();
        read_modules(folder, "", &mut modules)?;
        if modules.is_empty() {
            return Err(GpuError::Shader {
                name: folder.display().to_string(),
                message: "the folder holds no .wesl files".to_owned(),
            });
        }
        Ok(Self::with_generated(modules))
    }

    fn with_generated(mut modules: BTreeMap<String, Cow<'static, str>>) -> Self {
        let generated = shared::modules().into_iter();
        modules.extend(generated.map(|(name, text)| (format!("generated/{name}"), text.into())));
        Self { modules }
    }

    /// The same with another text of one module.
    #[cfg(test)]
    pub fn with(mut self, name: &str, text: &str) -> Self {
        self.modules.insert(name.to_owned(), text.to_owned().into());
        self
    }

    /// The names of all modules, such as `view/shade`.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.modules.keys().map(String::as_str)
    }

    /// The names of modules that only one of the two libraries has, or whose texts differ.
    pub fn differences<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = &'a str> {
        let changed = self
            .names()
            .filter(|&name| self.modules.get(name) != other.modules.get(name));
        let gone = other
            .names()
            .filter(|&name| !self.modules.contains_key(name));
        changed.chain(gone)
    }

    /// The text of a module.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.modules.get(name).map(|text| &**text)
    }

    /// Resolves the imports of module `name` (`view/shade`). `generated` adds modules that are made for
    /// one kernel, imported as `package::generated::NAME`. The same modules give the same bytes.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with its position, for a missing module, a syntax error or a type error.
    pub fn compose(&self, name: &str, generated: &[(&str, &str)]) -> Result<Composed, GpuError> {
        let fault = |message: String| GpuError::Shader {
            name: name.to_owned(),
            message,
        };
        let root: ModulePath = format!("package::{}", name.replace('/', "::"))
            .parse()
            .map_err(|error| fault(format!("{error:?}")))?;
        let resolver = LibraryResolver {
            shaders: self,
            generated,
        };
        let options = CompileOptions {
            validate: false,
            ..CompileOptions::default()
        };
        let mut resolved = wesl::compile_sourcemap(&root, &resolver, &ReadableMangler, &options)
            .map_err(|error| fault(without_colours(&error.to_string())))?;
        put_in_order(&mut resolved.syntax);
        let wgsl = resolved.syntax.to_string();
        let modules = resolved.modules.iter();
        let mut sources: Vec<String> = modules.map(|path| path.components.join("/")).collect();
        sources.sort();
        let module = naga::front::wgsl::parse_str(&wgsl)
            .map_err(|error| fault(error.emit_to_string_with_path(&wgsl, name)))?;
        let info = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::all(),
        )
        .validate(&module)
        .map_err(|error| fault(error.emit_to_string_with_path(&wgsl, name)))?;
        Ok(Composed {
            name: name.to_owned(),
            wgsl,
            module,
            info,
            sources,
        })
    }
}

/// Sorts declarations by their modules, and keeps the order within a module. WESL 0.4.0 visits the
/// entry points of a shader, and so the modules that they import, in the order of a hash map, which
/// differs in each run.
fn put_in_order(shader: &mut TranslationUnit) {
    shader
        .global_directives
        .sort_by_cached_key(ToString::to_string);
    shader
        .global_declarations
        .sort_by_cached_key(|declaration| place(declaration.node()));
}

/// The module of a declaration, as a sort key; without a name that contains the module, the
/// declaration's own text.
fn place(declaration: &GlobalDeclaration) -> (String, String) {
    let named = match declaration {
        GlobalDeclaration::Declaration(Declaration { ident, .. })
        | GlobalDeclaration::TypeAlias(TypeAlias { ident, .. })
        | GlobalDeclaration::Struct(Struct { ident, .. })
        | GlobalDeclaration::Function(Function { ident, .. }) => ident.name(),
        GlobalDeclaration::Void | GlobalDeclaration::ConstAssert(_) => {
            return (String::new(), declaration.to_string());
        }
    };
    // The shader's own module keeps the names of its source.
    let module = named.split_once("__").map_or("", |(_, module)| module);
    (module.to_owned(), String::new())
}

/// A text without its terminal colour codes (ECMA-48: ESC [ … letter).
fn without_colours(text: &str) -> String {
    let mut parts = text.split("\x1b[");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| c.is_ascii_alphabetic());
        plain.push_str(end.map_or("", |end| &part[end + 1..]));
    }
    plain
}

/// Reads the `.wesl` files under `folder`; their names begin with `prefix`.
fn read_modules(
    folder: &Path,
    prefix: &str,
    modules: &mut BTreeMap<String, Cow<'static, str>>,
) -> Result<(), GpuError> {
    let unreadable = |path: &Path, error: std::io::Error| GpuError::Shader {
        name: path.display().to_string(),
        message: format!("cannot be read: {error}"),
    };
    for entry in fs::read_dir(folder).map_err(|error| unreadable(folder, error))? {
        let path = entry.map_err(|error| unreadable(folder, error))?.path();
        let name = |part: Option<&std::ffi::OsStr>| {
            format!("{prefix}{}", part.unwrap_or_default().to_string_lossy())
        };
        if path.is_dir() {
            read_modules(&path, &format!("{}/", name(path.file_name())), modules)?;
        } else if path
            .extension()
            .is_some_and(|extension| extension == "wesl")
        {
            let text = fs::read_to_string(&path).map_err(|error| unreadable(&path, error))?;
            modules.insert(name(path.file_stem()), text.into());
        }
    }
    Ok(())
}

struct LibraryResolver<'a> {
    shaders: &'a ShaderLibrary,
    generated: &'a [(&'a str, &'a str)],
}

impl Resolver for LibraryResolver<'_> {
    fn resolve_source<'b>(&'b self, path: &ModulePath) -> Result<Cow<'b, str>, ResolveError> {
        let name = path.components.join("/");
        let missing = || ResolveError::ModuleNotFound(path.clone(), format!("no shader `{name}`"));
        if let Some(generated) = name.strip_prefix("generated/") {
            let found = self.generated.iter().find(|(known, _)| *known == generated);
            if let Some((_, text)) = found {
                return Ok((*text).into());
            }
        }
        let text = self.shaders.modules.get(name.as_str());
        text.map(|text| (&**text).into()).ok_or_else(missing)
    }

    fn display_name(&self, path: &ModulePath) -> Option<String> {
        Some(format!("shaders/{}.wesl", path.components.join("/")))
    }
}

/// `march::march` of module `march/march` becomes `march__march_march`: readable in captures, and
/// [`base_name`] recovers the name in the source.
struct ReadableMangler;

impl Mangler for ReadableMangler {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        format!("{item}__{}", path.components.join("_"))
    }
}

/// The name of a declaration as its own module spells it.
pub(super) fn base_name(mangled: &str) -> &str {
    mangled.split("__").next().unwrap_or(mangled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_equals_the_embedded_library() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let read = ShaderLibrary::from_folder(&folder).expect("the repository's own shaders");
        assert_eq!(read, ShaderLibrary::embedded());
        assert_eq!(read.differences(&ShaderLibrary::embedded()).count(), 0);
    }

    #[test]
    fn messages_are_plain() {
        assert_eq!(
            without_colours("a\x1b[1m\x1b[91mb\x1b[0m: c[0]"),
            "ab: c[0]"
        );
        let library = ShaderLibrary {
            modules: [("passes/broken".to_owned(), "fn main( {".into())].into(),
        };
        let Err(error) = library.compose("passes/broken", &[]) else {
            panic!("it has a syntax error");
        };
        assert!(!error.to_string().contains('\x1b'), "{error:?}");
        assert!(
            error.to_string().contains("passes/broken.wesl:1"),
            "{error}"
        );
    }

    #[test]
    fn a_shader_depends_on_nothing_but_its_sources() {
        let library = ShaderLibrary::embedded();
        for name in [
            "view/shade",
            "view/tonemap",
            "probes/blend",
            "scene/lamp_lists",
        ] {
            let whole = library.compose(name, &[]).expect(name);
            let mut sources = library.clone();
            (sources.modules).retain(|module, _| whole.sources.contains(module));
            assert!(sources.names().count() < library.names().count());
            let again = sources.compose(name, &[]).expect(name);
            assert!(again.wgsl == whole.wgsl && again.sources == whole.sources);
        }
    }

    #[test]
    fn an_edit_and_a_removal_are_differences() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
            fs::write(path, text).expect("writable");
        };
        let read = || ShaderLibrary::from_folder(folder.path());
        assert!(read().is_err(), "nothing there yet");
        write("passes/a.wesl", "fn a() {}");
        write("b.wesl", "fn b() {}");
        write("b.wesl~", "an editor's copy");
        let before = read().expect("two modules");
        let own = before
            .names()
            .filter(|name| !name.starts_with("generated/"));
        assert_eq!(own.collect::<Vec<_>>(), ["b", "passes/a"]);
        write("passes/a.wesl", "fn a() { b(); }");
        fs::remove_file(folder.path().join("b.wesl")).expect("it is there");
        let after = read().expect("one module");
        let differences: Vec<_> = after.differences(&before).collect();
        assert_eq!(differences, ["passes/a", "b"]);
    }
}
