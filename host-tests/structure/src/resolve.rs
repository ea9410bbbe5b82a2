//! Resolution of a path as by the compiler: through modules, renamed imports, re-exports and globs, to the item where it is defined.

use crate::sources::{Binding, Import, Item, Meaning, Sources};

/// Meaning of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// Module of the target.
    Module(usize),
    /// Item of the target; the rest of the path belongs to it.
    Item(Item),
    /// Another crate, the prelude, a local variable, a type parameter.
    Foreign,
}

/// Name lookup on behalf of module `from`, which decides which private names are visible.
pub struct Resolver<'a> {
    sources: &'a Sources,
    from: usize,
    /// Imports in progress, globs with the name sought: none is followed within itself.
    following: Vec<(usize, String)>,
}

impl<'a> Resolver<'a> {
    /// Lookup on behalf of a module of the sources.
    pub fn new(sources: &'a Sources, from: usize) -> Self {
        Self { sources, from, following: vec![] }
    }

    /// All meanings of a path in `module`: one name can be a module and a function, or two items under two conditions. Empty if the path
    /// begins in this target and cannot be resolved.
    pub fn resolve(&mut self, module: usize, path: &[String]) -> Vec<Target> {
        let (mut found, rest) = self.start(module, path);
        for name in rest {
            let within = |target| match target {
                Target::Module(module) => {
                    let found = self.lookup(module, name);
                    let here = &self.sources.modules[module];
                    if found.is_empty() && here.generated {
                        return vec![Target::Item(Item { is_container: true, ..Item::at(name, here.file, module) })];
                    }
                    found
                }
                Target::Item(item) if item.is_container => vec![Target::Item(item)],
                Target::Item(_) => vec![],
                Target::Foreign => vec![Target::Foreign],
            };
            found = found.into_iter().flat_map(within).collect();
        }
        found
    }

    /// Meanings of the first segments of a path, and the rest of the path.
    fn start<'p>(&mut self, module: usize, path: &'p [String]) -> (Vec<Target>, &'p [String]) {
        let named = self.sources.named(module);
        match path[0].as_str() {
            "crate" => (vec![Target::Module(0)], &path[1..]),
            "self" => self.above(named, &path[1..]),
            "super" => self.above(named, path),
            "" | "Self" => (vec![Target::Foreign], &path[1..]),
            name => {
                let mut found = self.in_scope(module, name);
                // A function does not hide a crate of the same name at the start of a longer path.
                if path.len() > 1 && found.iter().all(|it| matches!(it, Target::Item(item) if !item.is_container)) {
                    found = vec![Target::Foreign];
                }
                (found, &path[1..])
            }
        }
    }

    fn above<'p>(&self, mut module: usize, mut path: &'p [String]) -> (Vec<Target>, &'p [String]) {
        while path.first().is_some_and(|name| name == "super") {
            match self.sources.modules[module].parent {
                Some(parent) => module = self.sources.named(parent),
                None => return (vec![], path),
            }
            path = &path[1..];
        }
        (vec![Target::Module(module)], path)
    }

    /// Meanings of a first segment: in enclosing blocks, in the module, as a macro of the parent modules, or foreign.
    fn in_scope(&mut self, mut module: usize, name: &str) -> Vec<Target> {
        loop {
            let found = self.lookup(module, name);
            let here = &self.sources.modules[module];
            match here.parent {
                _ if !found.is_empty() => return found,
                Some(parent) if here.block => module = parent,
                _ => break,
            }
        }
        while let Some(parent) = self.sources.modules[module].parent {
            module = parent;
            let here = self.sources.modules[module].names.get(name);
            for Binding { meaning, .. } in here.into_iter().flatten() {
                match meaning {
                    Meaning::Item(item) if item.is_macro => return vec![Target::Item(item.clone())],
                    _ => {}
                }
            }
        }
        vec![Target::Foreign]
    }

    /// Meanings of a name in a module: bound there, or through its globs.
    fn lookup(&mut self, module: usize, name: &str) -> Vec<Target> {
        let here = &self.sources.modules[module];
        let mut found = vec![];
        for binding in here.names.get(name).into_iter().flatten() {
            if binding.public || self.sees(module) {
                found.extend(self.follow(module, binding));
            }
        }
        // An item shadows globs; a module does not shadow a function.
        if found.iter().any(|target| !matches!(target, Target::Module(_))) {
            return found;
        }
        let mut foreign = vec![];
        for glob in &here.globs {
            if !(glob.public || self.sees(module)) {
                continue;
            }
            for target in self.import(module, glob) {
                match target {
                    Target::Module(within) => found.extend(self.follow_once(glob, name, |it| it.lookup(within, name))),
                    Target::Item(item) if item.variants.iter().any(|it| it == name) => found.push(Target::Item(item)),
                    Target::Item(_) => {}
                    Target::Foreign => foreign.push(Target::Foreign),
                }
            }
        }
        if found.is_empty() { foreign } else { found }
    }

    fn sees(&self, module: usize) -> bool {
        self.sources.is_within(self.from, self.sources.named(module))
    }

    /// Follows an import, unless it is in progress.
    fn follow_once<T>(&mut self, import: &Import, name: &str, follow: impl FnOnce(&mut Self) -> Vec<T>) -> Vec<T> {
        let step = (import.id, name.to_string());
        if self.following.contains(&step) {
            return vec![];
        }
        self.following.push(step);
        let found = follow(self);
        self.following.pop();
        found
    }

    fn follow(&mut self, module: usize, binding: &Binding) -> Vec<Target> {
        match &binding.meaning {
            Meaning::Module(module) => vec![Target::Module(*module)],
            Meaning::Item(item) => vec![Target::Item(item.clone())],
            Meaning::Import(import) => self.import(module, import),
        }
    }

    fn import(&mut self, module: usize, import: &Import) -> Vec<Target> {
        self.follow_once(import, "", |it| {
            // An import sees the private names of its own module.
            let from = std::mem::replace(&mut it.from, module);
            let found = it.resolve(module, &import.path);
            it.from = from;
            found
        })
    }

    /// All names that a glob of `module` brings, with their meanings.
    pub fn all(&mut self, module: usize) -> Vec<(String, Target)> {
        let here = &self.sources.modules[module];
        let mut found = vec![];
        for (name, bindings) in &here.names {
            for binding in bindings.iter().filter(|it| it.public || self.sees(module)).collect::<Vec<_>>() {
                found.extend(self.follow(module, binding).into_iter().map(|target| (name.clone(), target)));
            }
        }
        for glob in &here.globs {
            if glob.public || self.sees(module) {
                for target in self.import(module, glob) {
                    if let Target::Module(within) = target {
                        found.extend(self.follow_once(glob, "*", |it| it.all(within)));
                    }
                }
            }
        }
        found
    }
}
