//! Default classes: what elements say where they are silent themselves.

use super::element::Element;
use super::error::Checked;
use super::grammar::{CLASS, GENERAL, GEOM, Grammar, JOINT, MOTOR, POSITION};
use roxmltree::NodeId;

/// The class of elements that name none.
const MAIN: &str = "main";

/// Elements that share their defaults.
const FAMILIES: [&[&str]; 2] = [
    &["general", "motor", "position"],
    &["tendon", "fixed", "spatial"],
];

/// Attributes that are never shared.
const OF_ONE: [&str; 3] = ["name", "class", "joint"];

/// Stands for a class that is named and not there.
const UNKNOWN: usize = 0;

pub struct Classes<'a> {
    /// The first is [`UNKNOWN`].
    classes: Vec<Class<'a>>,
    /// Whether all are known by their names.
    complete: bool,
}

struct Class<'a> {
    name: &'a str,
    parent: Option<usize>,
    id: NodeId,
    element: Element<'a>,
}

impl<'a> Classes<'a> {
    pub fn read(root: &Element<'a>) -> Self {
        let unknown = Class {
            name: "",
            parent: None,
            id: root.id(),
            element: root.clone(),
        };
        let mut read = Classes {
            classes: vec![unknown],
            complete: true,
        };
        for top in root.sections("default") {
            for element in top.nested("default") {
                read.add(element, top.id());
            }
        }
        read
    }

    fn add(&mut self, element: Element<'a>, top: NodeId) {
        element.check(&CLASS);
        for child in element.children() {
            if let Some(grammar) = grammar(child.tag()) {
                child.check(grammar);
                let own = OF_ONE.into_iter().find(|name| child.word(name).is_some());
                if let Some(name) = own {
                    child.report(child.wrong(name, "a default cannot have it"));
                }
            }
        }
        let outermost = element.id() == top;
        let Some(name) = element.keep(self.class_name(&element, outermost)) else {
            self.complete = false;
            return;
        };
        // An outermost one that is repeated goes on where the last one ended.
        let parent = match outermost {
            true => self.classes.iter().rposition(|class| class.name == MAIN),
            false => {
                let around = |class: &Class| Some(class.id) == element.parent();
                self.classes.iter().position(around).or(Some(UNKNOWN))
            }
        };
        self.classes.push(Class {
            name,
            parent,
            id: element.id(),
            element,
        });
    }

    fn class_name(&self, element: &Element<'a>, outermost: bool) -> Checked<&'a str> {
        let name = match element.word("class") {
            None if outermost => MAIN,
            None => return Err(element.error("needs a class: only the outermost has none")),
            Some(name) => name,
        };
        if outermost && name != MAIN {
            return Err(element.wrong("class", "the outermost class is called main"));
        }
        let known = self.classes.iter().any(|class| class.name == name);
        match known && !outermost {
            true => Err(element.wrong("class", "there is a class of this name already")),
            false => Ok(name),
        }
    }

    fn find(&self, element: &Element<'a>, attribute: &str) -> Option<usize> {
        let name = element.word(attribute)?;
        let mut classes = self.classes.iter();
        match classes.rposition(|class| class.name == name) {
            None | Some(UNKNOWN) => {
                if self.complete {
                    let problem = "there is no such class in <default>";
                    element.report(element.wrong(attribute, problem));
                }
                Some(UNKNOWN)
            }
            found => found,
        }
    }

    /// The class that a body or frame gives to what is in it, if it names one.
    pub fn of_children(&self, body: &Element<'a>) -> Option<usize> {
        self.find(body, "childclass")
    }

    /// The element with the defaults of its own class, or else of the one it stands in.
    pub fn apply(&self, element: Element<'a>, around: Option<usize>) -> Element<'a> {
        let main = self.classes.iter().rposition(|class| class.name == MAIN);
        let class = self.find(&element, "class").or(around).or(main);
        let up = |&index: &usize| self.classes[index].parent;
        let mut way: Vec<usize> = std::iter::successors(class, up).collect();
        way.reverse();
        let speaks = |other: &Element| {
            let both = [other.tag(), element.tag()];
            let shared = |family: &&[&str]| both.iter().all(|tag| family.contains(tag));
            both[0] == both[1] || FAMILIES.iter().any(shared)
        };
        let children = way
            .iter()
            .flat_map(|&index| self.classes[index].element.children());
        let defaults: Vec<Element> = children.filter(speaks).collect();
        match self.complete && way.first() != Some(&UNKNOWN) {
            true => element.with_defaults(&defaults),
            false => element.with_defaults(&defaults).without_class(),
        }
    }
}

fn grammar(tag: &str) -> Option<&'static Grammar> {
    match tag {
        "joint" => Some(&JOINT),
        "geom" => Some(&GEOM),
        "general" => Some(&GENERAL),
        "motor" => Some(&MOTOR),
        "position" => Some(&POSITION),
        _ => None,
    }
}
