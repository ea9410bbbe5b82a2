//! Paths that syn does not provide: among the tokens of a macro call, and in the tree of a `use`.

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use syn::ext::IdentExt;

/// One name brought by a `use`, or one glob.
pub struct Leaf {
    /// Whole path, without the `*`.
    pub path: Vec<String>,
    /// Bound name; `None` for a glob and for `as _`.
    pub name: Option<syn::Ident>,
    /// True for `*`.
    pub glob: bool,
    /// Position in the source.
    pub at: Span,
}

/// Every name of a `use` tree.
pub fn leaves(path: Vec<String>, tree: &syn::UseTree) -> Vec<Leaf> {
    let with = |ident: &syn::Ident| [path.clone(), vec![ident.unraw().to_string()]].concat();
    match tree {
        syn::UseTree::Path(step) => leaves(with(&step.ident), &step.tree),
        syn::UseTree::Group(group) => group.items.iter().flat_map(|tree| leaves(path.clone(), tree)).collect(),
        syn::UseTree::Glob(glob) => vec![Leaf { path, name: None, glob: true, at: glob.star_token.spans[0] }],
        syn::UseTree::Name(leaf) => {
            let at = leaf.ident.span();
            if leaf.ident == "self" && !path.is_empty() {
                let name = path.last().filter(|name| !matches!(name.as_str(), "self" | "super" | "crate"));
                let name = name.map(|name| syn::Ident::new_raw(name, at));
                return vec![Leaf { path, name, glob: false, at }];
            }
            vec![Leaf { path: with(&leaf.ident), name: Some(leaf.ident.clone()), glob: false, at }]
        }
        syn::UseTree::Rename(leaf) => {
            let path = if leaf.ident == "self" && !path.is_empty() { path } else { with(&leaf.ident) };
            let name = Some(leaf.rename.clone()).filter(|name| name != "_");
            vec![Leaf { path, name, glob: false, at: leaf.ident.span() }]
        }
    }
}

/// Likely paths: `a::b` anywhere; a single name if it is called or begins with a capital.
pub fn paths(tokens: TokenStream) -> Vec<(Vec<String>, Span)> {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let is = |at: usize, sign: char| matches!(tokens.get(at), Some(TokenTree::Punct(it)) if it.as_char() == sign);
    let mut found = vec![];
    let mut at = 0;
    while at < tokens.len() {
        let first = match &tokens[at] {
            TokenTree::Group(group) => {
                found.extend(paths(group.stream()));
                at += 1;
                continue;
            }
            TokenTree::Ident(first) => first,
            _ => {
                at += 1;
                continue;
            }
        };
        if first == "use"
            && let Some(end) = (at..tokens.len()).find(|&end| is(end, ';'))
            && let Ok(tree) = syn::parse2::<syn::UseTree>(tokens[at + 1..end].iter().cloned().collect())
        {
            found.extend(leaves(vec![], &tree).into_iter().map(|leaf| (leaf.path, leaf.at)));
            at = end;
            continue;
        }
        let start = at;
        let mut path = vec![first.unraw().to_string()];
        at += 1;
        while is(at, ':')
            && is(at + 1, ':')
            && let Some(TokenTree::Ident(next)) = tokens.get(at + 2)
        {
            path.push(next.unraw().to_string());
            at += 3;
        }
        let before = |back: usize, sign| start.checked_sub(back).is_some_and(|at| is(at, sign));
        let variable = before(1, '$') && path[0] != "crate";
        let field = before(1, '.') && !before(2, '.');
        let continued = before(1, ':') && before(2, ':');
        let defined = start > 0 && matches!(&tokens[start - 1], TokenTree::Ident(it) if it == "fn");
        let called = matches!(tokens.get(at), Some(TokenTree::Group(it)) if it.delimiter() == Delimiter::Parenthesis)
            || is(at, '!');
        let telling = path.len() > 1 || called || path[0].starts_with(char::is_uppercase);
        if telling && !(variable || field || continued || defined) {
            found.push((path, first.span()));
        }
    }
    found
}
