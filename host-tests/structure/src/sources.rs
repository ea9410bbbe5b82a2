//! Modules of one target (a library, a binary, a test program) as written in its files: the names bound by each module, and every path
//! written in it. Nothing is resolved here.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use proc_macro2::Span;
use syn::ext::IdentExt;
use syn::visit::{self, Visit};

use crate::tokens;

/// Returns the text of a file, if it exists. Tests provide texts from memory.
pub type Reader<'a> = &'a dyn Fn(&Path) -> Option<String>;

/// One target, as written.
#[derive(Default)]
pub struct Sources {
    /// Files; the first is the root's.
    pub files: Vec<File>,
    /// Modules; the first is the root. A block that contains items is a module without a name.
    pub modules: Vec<Module>,
    /// Paths in the order of the text.
    pub references: Vec<Reference>,
    /// Files that could not be read, with the reason.
    pub unread: Vec<String>,
}

/// File of the target.
pub struct File {
    /// Path as passed to the reader.
    pub path: PathBuf,
    /// Lines of code, without inline modules for tests only; zero if the file is such a module.
    pub lines: usize,
    /// True for a module named `design` and everything below it.
    pub design: bool,
}

/// Module, or block that contains items.
pub struct Module {
    /// Enclosing module.
    pub parent: Option<usize>,
    /// File of the body.
    pub file: usize,
    /// True for a block: names are looked up in the parent as well, and `self` is the parent's.
    pub block: bool,
    /// True if a macro or a generated file adds names that are not visible here.
    pub generated: bool,
    /// Bindings by name; one name can be bound several times, under different conditions.
    pub names: HashMap<String, Vec<Binding>>,
    /// Imports of the form `use ...::*`.
    pub globs: Vec<Import>,
}

/// Binding of a name in a module.
#[derive(Clone)]
pub struct Binding {
    /// Visible outside its module and the modules within.
    pub public: bool,
    /// Meaning of the name.
    pub meaning: Meaning,
}

/// Meaning of a bound name.
#[derive(Clone)]
pub enum Meaning {
    /// A module.
    Module(usize),
    /// A type, function, constant, trait or macro, defined here.
    Item(Item),
    /// An import.
    Import(Import),
}

/// Item where it is defined.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Name at the definition.
    pub name: String,
    /// File of the definition.
    pub file: usize,
    /// Module of the definition.
    pub module: usize,
    /// True if the name can stand before `::`.
    pub is_container: bool,
    /// Variants of an enum.
    pub variants: Vec<String>,
    /// True for a trait, whose methods are used without its name.
    pub is_trait: bool,
    /// True for a macro, visible below its module without an import.
    pub is_macro: bool,
}

impl Item {
    /// Item with its location only.
    pub fn at(name: &str, file: usize, module: usize) -> Self {
        Self {
            name: name.to_string(),
            file,
            module,
            is_container: false,
            variants: vec![],
            is_trait: false,
            is_macro: false,
        }
    }
}

/// Right side of a `use`.
#[derive(Clone)]
pub struct Import {
    /// Unique number.
    pub id: usize,
    /// Path without the `*`.
    pub path: Vec<String>,
    /// Visible from outside.
    pub public: bool,
}

/// Path somewhere in the sources.
pub struct Reference {
    /// Innermost module or block.
    pub module: usize,
    /// File of the path.
    pub file: usize,
    /// Line, from one.
    pub line: usize,
    /// Segments; an empty first segment stands for a leading `::`.
    pub path: Vec<String>,
    /// Syntactic position.
    pub place: Place,
}

/// Syntactic position of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// In an expression, a type, a pattern, an attribute.
    Code,
    /// Among the tokens of a macro, where it may mean nothing.
    Tokens,
    /// `use`
    Use,
    /// `pub use`
    Reexport,
    /// `use ...::*`
    Glob,
    /// `pub use ...::*`
    GlobReexport,
}

impl Sources {
    /// Reads a target from its root file.
    pub fn read(root: &Path, reader: Reader) -> Self {
        let mut sources = Self::default();
        let folder = root.parent().unwrap_or(Path::new("")).to_path_buf();
        sources.modules.push(Module::new(None, 0, false));
        let (module, file, locals) = (0, 0, vec![]);
        Walk { sources: &mut sources, reader, module, file, folder, inline: false, test: false, locals }
            .load(root, None, false);
        sources
    }

    /// Module that `self` means in `module`.
    pub fn named(&self, module: usize) -> usize {
        let it = &self.modules[module];
        if it.block { self.named(it.parent.expect("a block is in a module")) } else { module }
    }

    /// Returns true if `module` is `above` or within it.
    pub fn is_within(&self, module: usize, above: usize) -> bool {
        module == above || self.modules[module].parent.is_some_and(|parent| self.is_within(parent, above))
    }
}

impl Module {
    fn new(parent: Option<usize>, file: usize, block: bool) -> Self {
        Self { parent, file, block, generated: false, names: HashMap::new(), globs: vec![] }
    }
}

/// Walk through one file after the other; `module`, `file` and `folder` are the present position.
struct Walk<'a> {
    sources: &'a mut Sources,
    reader: Reader<'a>,
    module: usize,
    file: usize,
    /// Folder of the files of child modules.
    folder: PathBuf,
    /// Inside a module with a body in braces: `#[path]` is relative to `folder` instead of to the file's folder.
    inline: bool,
    /// Inside a module for tests only.
    test: bool,
    /// Names bound by patterns in the enclosing functions, which are not items.
    locals: Vec<BTreeSet<String>>,
}

impl Walk<'_> {
    /// Walks a file as the body of the present module.
    fn load(&mut self, path: &Path, asked: Option<Span>, design: bool) {
        let by = || match asked {
            Some(at) => format!("{}:{}", self.sources.files[self.file].path.display(), at.start().line),
            None => "Cargo".to_string(),
        };
        let Some(text) = (self.reader)(path) else {
            let by = by();
            return self.sources.unread.push(format!("{by} asks for {}, which cannot be read", path.display()));
        };
        let parsed = match syn::parse_file(&text) {
            Ok(parsed) => parsed,
            Err(error) => {
                let line = error.span().start().line;
                return self.sources.unread.push(format!("{}:{line} does not parse: {error}", path.display()));
            }
        };
        let outer = self.file;
        self.file = self.sources.files.iter().position(|file| file.path == path).unwrap_or_else(|| {
            let lines = if self.test { 0 } else { text.lines().count() };
            self.sources.files.push(File { path: path.to_path_buf(), lines, design });
            self.sources.files.len() - 1
        });
        self.visit_file(&parsed);
        self.file = outer;
    }

    fn bind(&mut self, name: &syn::Ident, public: bool, meaning: Meaning) {
        let names = &mut self.sources.modules[self.module].names;
        names.entry(name.unraw().to_string()).or_default().push(Binding { public, meaning });
    }

    fn bind_item(&mut self, name: &syn::Ident, visibility: &syn::Visibility, describe: impl FnOnce(&mut Item)) {
        let mut item = Item::at(&name.unraw().to_string(), self.file, self.module);
        describe(&mut item);
        self.bind(name, is_public(visibility), Meaning::Item(item));
    }

    fn refer(&mut self, path: Vec<String>, at: Span, place: Place) {
        let (module, file, line) = (self.module, self.file, at.start().line);
        self.sources.references.push(Reference { module, file, line, path, place });
    }

    fn refer_tokens(&mut self, tokens: proc_macro2::TokenStream) {
        for (path, at) in tokens::paths(tokens) {
            self.refer(path, at, Place::Tokens);
        }
    }

    fn within(&mut self, module: usize, walk: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.module, module);
        walk(self);
        self.module = outer;
    }

    fn child(&mut self, block: bool) -> usize {
        self.sources.modules.push(Module::new(Some(self.module), self.file, block));
        self.sources.modules.len() - 1
    }

    /// Records the names that patterns bind within a function while it is walked.
    fn with_locals(&mut self, find: impl FnOnce(&mut Locals), walk: impl FnOnce(&mut Self)) {
        let mut locals = Locals::default();
        find(&mut locals);
        self.locals.push(locals.0);
        walk(self);
        self.locals.pop();
    }
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        module.attrs.iter().for_each(|attribute| self.visit_attribute(attribute));
        let name = module.ident.unraw().to_string();
        let child = self.child(false);
        self.bind(&module.ident, is_public(&module.vis), Meaning::Module(child));
        let (folder, inline, test, file) = (self.folder.clone(), self.inline, self.test, self.file);
        self.test |= module.attrs.iter().any(is_for_tests);
        let design = self.sources.files[file].design || name == "design";
        if let Some((brace, items)) = &module.content {
            if self.test && !test {
                let lines = brace.span.close().end().line - module.mod_token.span.start().line + 1;
                self.sources.files[file].lines -= lines;
            }
            self.folder.push(name);
            self.inline = true;
            self.within(child, |walk| items.iter().for_each(|item| walk.visit_item(item)));
        } else {
            let here = self.sources.files[file].path.parent().expect("a file is in a folder").to_path_buf();
            let path = match module.attrs.iter().find_map(path_attribute) {
                Some(path) => joined(if self.inline { &folder } else { &here }, &path),
                None => {
                    let nested = folder.join(&name).join("mod.rs");
                    if (self.reader)(&nested).is_some() { nested } else { folder.join(format!("{name}.rs")) }
                }
            };
            // Children of `foo.rs` are in `foo/`, those of `foo/mod.rs` and of a file named by `#[path]` beside it.
            let beside = path.ends_with("mod.rs") || module.attrs.iter().any(|it| path_attribute(it).is_some());
            self.folder = if beside { path.with_file_name("") } else { path.with_extension("") };
            self.inline = false;
            self.sources.modules[child].file = self.sources.files.len();
            self.within(child, |walk| walk.load(&path, Some(module.ident.span()), design));
        }
        (self.folder, self.inline, self.test) = (folder, inline, test);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        item.attrs.iter().for_each(|attribute| self.visit_attribute(attribute));
        let start = if item.leading_colon.is_some() { vec![String::new()] } else { vec![] };
        let public = is_public(&item.vis);
        for leaf in tokens::leaves(start, &item.tree) {
            let import = Import { id: self.sources.references.len(), path: leaf.path.clone(), public };
            match leaf.name {
                Some(name) => self.bind(&name, public, Meaning::Import(import)),
                None if leaf.glob => self.sources.modules[self.module].globs.push(import),
                None => {}
            }
            let place = match (leaf.glob, public) {
                (false, false) => Place::Use,
                (false, true) => Place::Reexport,
                (true, false) => Place::Glob,
                (true, true) => Place::GlobReexport,
            };
            self.refer(leaf.path, leaf.at, place);
        }
    }

    fn visit_item_macro(&mut self, item: &'ast syn::ItemMacro) {
        match &item.ident {
            Some(name) => {
                let exported = item.attrs.iter().any(|it| it.path().is_ident("macro_export"));
                let public = syn::Visibility::Public(Default::default());
                self.within(if exported { 0 } else { self.module }, |walk| {
                    walk.bind_item(name, &public, |item| item.is_macro = true);
                });
                self.refer_tokens(item.mac.tokens.clone());
            }
            // The text becomes part of this module, as a child's does by `mod`: naming it is no import.
            None if item.mac.path.is_ident("include") && item.mac.parse_body::<syn::LitStr>().is_ok() => {
                let name = item.mac.parse_body::<syn::LitStr>().expect("as just parsed");
                let path = joined(&self.sources.files[self.file].path.with_file_name(""), &name.value());
                self.load(&path, Some(name.span()), self.sources.files[self.file].design);
            }
            None => {
                let module = self.sources.named(self.module);
                self.sources.modules[module].generated = true;
                self.visit_macro(&item.mac);
            }
        }
    }

    fn visit_item(&mut self, item: &'ast syn::Item) {
        match item {
            syn::Item::Struct(it) => self.bind_item(&it.ident, &it.vis, |item| item.is_container = true),
            syn::Item::Union(it) => self.bind_item(&it.ident, &it.vis, |item| item.is_container = true),
            syn::Item::Type(it) => self.bind_item(&it.ident, &it.vis, |item| item.is_container = true),
            syn::Item::Enum(it) => self.bind_item(&it.ident, &it.vis, |item| {
                item.is_container = true;
                item.variants = it.variants.iter().map(|variant| variant.ident.unraw().to_string()).collect();
            }),
            syn::Item::Trait(it) => self.bind_item(&it.ident, &it.vis, |item| {
                item.is_container = true;
                item.is_trait = true;
            }),
            syn::Item::Const(it) => self.bind_item(&it.ident, &it.vis, |_| ()),
            syn::Item::Static(it) => self.bind_item(&it.ident, &it.vis, |_| ()),
            syn::Item::Fn(it) => self.bind_item(&it.sig.ident, &it.vis, |_| ()),
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_foreign_item(&mut self, item: &'ast syn::ForeignItem) {
        match item {
            syn::ForeignItem::Fn(it) => self.bind_item(&it.sig.ident, &it.vis, |_| ()),
            syn::ForeignItem::Static(it) => self.bind_item(&it.ident, &it.vis, |_| ()),
            _ => {}
        }
        visit::visit_foreign_item(self, item);
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.with_locals(|locals| locals.visit_item_fn(item), |walk| visit::visit_item_fn(walk, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.with_locals(|locals| locals.visit_impl_item_fn(item), |walk| visit::visit_impl_item_fn(walk, item));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        self.with_locals(|locals| locals.visit_trait_item_fn(item), |walk| visit::visit_trait_item_fn(walk, item));
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        if block.stmts.iter().any(|statement| matches!(statement, syn::Stmt::Item(_))) {
            let child = self.child(true);
            self.within(child, |walk| visit::visit_block(walk, block));
        } else {
            visit::visit_block(self, block);
        }
    }

    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        call.attrs.iter().for_each(|attribute| self.visit_attribute(attribute));
        // A call names a function even where a local variable has the same name: `let energy = energy(state)`.
        match &*call.func {
            syn::Expr::Path(function) => visit::visit_expr_path(self, function),
            other => self.visit_expr(other),
        }
        call.args.iter().for_each(|argument| self.visit_expr(argument));
    }

    fn visit_expr(&mut self, expression: &'ast syn::Expr) {
        if let syn::Expr::Path(path) = expression
            && let Some(name) = path.path.get_ident()
            && self.locals.iter().any(|locals| locals.contains(&name.to_string()))
        {
            return;
        }
        visit::visit_expr(self, expression);
    }

    fn visit_pat_ident(&mut self, pattern: &'ast syn::PatIdent) {
        if is_constant(&pattern.ident) {
            self.refer(vec![pattern.ident.unraw().to_string()], pattern.ident.span(), Place::Code);
        }
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let mut segments = if path.leading_colon.is_some() { vec![String::new()] } else { vec![] };
        segments.extend(path.segments.iter().map(|segment| segment.ident.unraw().to_string()));
        self.refer(segments, path.segments[0].ident.span(), Place::Code);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.visit_path(&item.path);
        self.refer_tokens(item.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast syn::Attribute) {
        match &attribute.meta {
            syn::Meta::List(list) => {
                self.visit_path(&list.path);
                self.refer_tokens(list.tokens.clone());
            }
            syn::Meta::Path(path) => self.visit_path(path),
            syn::Meta::NameValue(_) => {}
        }
    }
}

/// Names bound by patterns; a name in capitals is a constant or a variant, which a pattern compares with.
#[derive(Default)]
struct Locals(BTreeSet<String>);

impl<'ast> Visit<'ast> for Locals {
    fn visit_pat_ident(&mut self, pattern: &'ast syn::PatIdent) {
        if !is_constant(&pattern.ident) {
            self.0.insert(pattern.ident.to_string());
        }
        visit::visit_pat_ident(self, pattern);
    }
}

/// Path without `..`, so that a file has one path.
fn joined(folder: &Path, relative: &str) -> PathBuf {
    let mut path = folder.to_path_buf();
    for part in Path::new(relative).components() {
        match part {
            std::path::Component::ParentDir => _ = path.pop(),
            part => path.push(part),
        }
    }
    path
}

fn is_constant(name: &syn::Ident) -> bool {
    name.unraw().to_string().starts_with(char::is_uppercase)
}

/// Returns true for `pub`, also with a restriction; `pub(self)` is private.
fn is_public(visibility: &syn::Visibility) -> bool {
    match visibility {
        syn::Visibility::Public(_) => true,
        syn::Visibility::Restricted(within) => !within.path.is_ident("self"),
        syn::Visibility::Inherited => false,
    }
}

fn is_for_tests(attribute: &syn::Attribute) -> bool {
    attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Path>().is_ok_and(|it| it.is_ident("test"))
}

fn path_attribute(attribute: &syn::Attribute) -> Option<String> {
    let syn::Meta::NameValue(pair) = &attribute.meta else { return None };
    let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(path), .. }) = &pair.value else { return None };
    pair.path.is_ident("path").then(|| path.value())
}
