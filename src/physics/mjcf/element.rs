//! An element of the file, its attributes as numbers and words, and errors that say where it stands.

use super::error::{Checked, Fault};
use super::grammar::Grammar;
use super::source::MjcfSource;
use roxmltree::{Attribute, Node, NodeId};

/// Larger numbers are mistakes, and would overflow when squared.
const LARGEST: f64 = 1e9;

#[derive(Clone)]
pub struct Element<'a> {
    source: &'a MjcfSource,
    node: Node<'a, 'a>,
    /// Those of default classes, which speak where this one is silent; the outermost class first.
    defaults: Vec<Node<'a, 'a>>,
    /// Whether its class is not there, or perhaps another's: it is not blamed for what that would say.
    classless: bool,
}

impl<'a> Element<'a> {
    pub fn new(source: &'a MjcfSource, node: Node<'a, 'a>) -> Self {
        Element {
            source,
            node,
            defaults: Vec::new(),
            classless: false,
        }
    }

    pub fn with_defaults(self, defaults: &[Element<'a>]) -> Self {
        Element {
            defaults: defaults.iter().map(|element| element.node).collect(),
            ..self
        }
    }

    pub fn without_class(self) -> Self {
        Element {
            classless: true,
            ..self
        }
    }

    pub fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    pub fn id(&self) -> NodeId {
        self.node.id()
    }

    pub fn parent(&self) -> Option<NodeId> {
        self.node.parent().map(|parent| parent.id())
    }

    pub fn children(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let source = self.source;
        let elements = self.node.children().filter(Node::is_element);
        elements.map(move |node| Element::new(source, node))
    }

    /// The children, if they are known, of the sections with this tag: a section may be repeated.
    pub fn within(&self, tag: &'static str, grammar: &Grammar) -> Vec<Element<'a>> {
        let mut all = Vec::new();
        for section in self.sections(tag) {
            section.check(grammar);
            let children = section.children();
            all.extend(children.filter(|child| grammar.within.contains(&child.tag())));
        }
        all
    }

    /// The children with this tag.
    pub fn sections(&self, tag: &'static str) -> impl Iterator<Item = Element<'a>> + use<'a> {
        self.children().filter(move |section| section.tag() == tag)
    }

    /// This one and all within that have a tag, parents before their children.
    pub fn nested(&self, tag: &'static str) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let source = self.source;
        let all = self.node.descendants();
        all.filter(move |node| node.has_tag_name(tag))
            .map(move |node| Element::new(source, node))
    }

    fn layers(&self) -> impl DoubleEndedIterator<Item = Node<'a, 'a>> {
        self.defaults.iter().copied().chain([self.node])
    }

    /// What is written in the element itself or else in the innermost class that knows.
    fn attribute(&self, name: &str) -> Option<Attribute<'a, 'a>> {
        self.layers().rev().find_map(|node| attribute(node, name))
    }

    pub fn word(&self, name: &str) -> Option<&'a str> {
        self.attribute(name).map(|attribute| attribute.value())
    }

    /// The element's own name; empty if it has none.
    pub fn name(&self) -> &'a str {
        self.node.attribute("name").unwrap_or_default()
    }

    /// The name of something else, which must be given.
    pub fn naming(&self, name: &str) -> Checked<&'a str> {
        let missing = || self.error(&format!("needs the attribute {name}"));
        self.word(name)
            .filter(|word| !word.is_empty())
            .ok_or_else(missing)
    }

    /// One of several words, by its index among them.
    pub fn choice(&self, name: &str, words: &[&str]) -> Checked<Option<usize>> {
        let Some(word) = self.word(name) else {
            return Ok(None);
        };
        let index = words.iter().position(|known| *known == word);
        let unknown = || self.wrong(name, &format!("it may be {}", words.join(" or ")));
        index.ok_or_else(unknown).map(Some)
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Checked<Option<[f64; N]>> {
        let Some(attribute) = self.attribute(name) else {
            return Ok(None);
        };
        let numbers = self.parse(&attribute)?;
        let found = numbers.len();
        let count = |_| self.wrong(name, &format!("expected {N} numbers, found {found}"));
        numbers.try_into().map_err(count).map(Some)
    }

    pub fn number(&self, name: &str) -> Checked<Option<f64>> {
        Ok(self.numbers::<1>(name)?.map(|[number]| number))
    }

    /// Up to `N` numbers, the last of which may be left out: each class, and last the element,
    /// overwrites as many as it has.
    pub fn overlay<const N: usize>(&self, name: &str, mut values: [f64; N]) -> Checked<[f64; N]> {
        for attribute in self.layers().filter_map(|node| attribute(node, name)) {
            let numbers = self.parse(&attribute)?;
            let found = numbers.len();
            if !(1..=N).contains(&found) {
                let count = format!("expected 1 to {N} numbers, found {found}");
                return Err(self.faulty(&attribute, &count));
            }
            values[..found].copy_from_slice(&numbers);
        }
        Ok(values)
    }

    /// The innermost layer for which there is an answer.
    pub fn innermost<T>(
        &self,
        answer: impl Fn(&Element<'a>) -> Checked<Option<T>>,
    ) -> Checked<Option<T>> {
        let alone = self.layers().rev();
        let mut answers =
            alone.filter_map(|node| answer(&Element::new(self.source, node)).transpose());
        answers.next().transpose()
    }

    /// Reports attributes and elements within that are not known, and attributes, those of classes among
    /// them, that must keep a value but do not.
    pub fn check(&self, grammar: &Grammar) {
        for attribute in self.layers().flat_map(|node| node.attributes()) {
            let only = grammar.only(attribute.name()).unwrap_or_default();
            let kept = only.iter().any(|value| same(value, attribute.value()));
            if !only.is_empty() && !kept {
                let only = format!("only {} is supported", only.join(" or "));
                self.report(self.faulty(&attribute, &only));
            }
        }
        let own = self.node.attributes();
        for unknown in own.filter(|attribute| !grammar.knows(attribute.name())) {
            self.report(self.faulty(&unknown, "this attribute is not supported; remove it"));
        }
        for child in self.children() {
            if !grammar.within.contains(&child.tag()) {
                self.report(child.error(&format!(
                    "is not supported in <{}>; remove it if the model can do without",
                    self.tag()
                )));
            }
        }
    }

    /// Takes note of what is wrong, so that the rest of the file can be looked at before it is refused.
    pub fn report(&self, fault: Fault) {
        self.source.report(fault);
    }

    /// What was read, unless it was wrong: that is reported.
    pub fn keep<T>(&self, read: Checked<T>) -> Option<T> {
        match read {
            Ok(read) => Some(read),
            Err(fault) if self.classless && fault.at == self.node.range().start => None,
            Err(fault) => {
                self.report(fault);
                None
            }
        }
    }

    /// An error of this element.
    pub fn error(&self, problem: &str) -> Fault {
        Fault {
            at: self.node.range().start,
            problem: format!("{} {problem}", self.title()),
        }
    }

    /// An error of what is written in one of its attributes.
    pub fn wrong(&self, name: &str, problem: &str) -> Fault {
        let Some(attribute) = self.attribute(name) else {
            return self.error(&format!("lacks {name}: {problem}"));
        };
        self.faulty(&attribute, problem)
    }

    fn faulty(&self, attribute: &Attribute, problem: &str) -> Fault {
        let (name, value) = (attribute.name(), attribute.value());
        Fault {
            at: attribute.range().start,
            problem: format!("{} has {name}=\"{value}\": {problem}", self.title()),
        }
    }

    fn title(&self) -> String {
        match self.node.attribute("name") {
            Some(name) => format!("<{}> '{name}'", self.tag()),
            None => format!("<{}>", self.tag()),
        }
    }

    fn parse(&self, attribute: &Attribute) -> Checked<Vec<f64>> {
        let number = |word: &str| match word.parse::<f64>() {
            Ok(value) if value.abs() <= LARGEST => Ok(value),
            Ok(_) => Err(self.faulty(attribute, &format!("'{word}' is no usable number"))),
            Err(_) => Err(self.faulty(attribute, &format!("'{word}' is no number"))),
        };
        attribute
            .value()
            .split_ascii_whitespace()
            .map(number)
            .collect()
    }
}

fn attribute<'a>(node: Node<'a, 'a>, name: &str) -> Option<Attribute<'a, 'a>> {
    node.attributes().find(|attribute| attribute.name() == name)
}

/// Whether two values are equal, as words or as numbers.
fn same(a: &str, b: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        let number = |word: &str| {
            word.parse::<f64>()
                .map_or(word.to_string(), |n| n.to_string())
        };
        text.split_ascii_whitespace().map(number).collect()
    };
    words(a) == words(b)
}
