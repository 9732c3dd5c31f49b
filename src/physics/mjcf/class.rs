//! Default classes: what elements say where they are silent themselves.

use super::element::Element;
use super::error::Result;
use super::grammar::{CLASS, GEOM, Grammar, JOINT, MOTOR, POSITION};
use roxmltree::NodeId;

/// The class of elements that name none.
const MAIN: &str = "main";

/// Actuators of all kinds share their defaults.
const ACTUATORS: [&str; 2] = ["motor", "position"];

/// Attributes that are never shared.
const OF_ONE: [&str; 3] = ["name", "class", "joint"];

pub struct Classes<'a> {
    classes: Vec<Class<'a>>,
}

struct Class<'a> {
    name: &'a str,
    parent: Option<usize>,
    id: NodeId,
    element: Element<'a>,
}

impl<'a> Classes<'a> {
    pub fn read(root: &Element<'a>) -> Result<Self> {
        let mut read = Classes {
            classes: Vec::new(),
        };
        for top in root.sections("default") {
            for element in top.nested("default") {
                read.add(element, top.id())?;
            }
        }
        Ok(read)
    }

    fn add(&mut self, element: Element<'a>, top: NodeId) -> Result<()> {
        element.check(&CLASS)?;
        let outermost = element.id() == top;
        let name = match element.word("class") {
            None if outermost => MAIN,
            None => return Err(element.error("needs a class: only the outermost has none")),
            Some(name) => name,
        };
        if outermost && name != MAIN {
            return Err(element.wrong("class", "the outermost class is called main"));
        }
        if self
            .classes
            .iter()
            .any(|class| class.name == name && !outermost)
        {
            return Err(element.wrong("class", "there is a class of this name already"));
        }
        for child in element.children() {
            if let Some(grammar) = grammar(child.tag()) {
                child.check(grammar)?;
                let own = OF_ONE.into_iter().find(|name| child.word(name).is_some());
                if let Some(name) = own {
                    return Err(child.wrong(name, "a default cannot have it"));
                }
            }
        }
        // An outermost one that is repeated goes on where the last one ended.
        let parent = match outermost {
            true => self.classes.iter().rposition(|class| class.name == MAIN),
            false => (self.classes.iter()).position(|class| Some(class.id) == element.parent()),
        };
        self.classes.push(Class {
            name,
            parent,
            id: element.id(),
            element,
        });
        Ok(())
    }

    fn find(&self, element: &Element<'a>, attribute: &str) -> Result<Option<usize>> {
        let Some(name) = element.word(attribute) else {
            return Ok(None);
        };
        let found = self.classes.iter().rposition(|class| class.name == name);
        let unknown = || element.wrong(attribute, "there is no such class in <default>");
        found.ok_or_else(unknown).map(Some)
    }

    /// The class that a body gives to what is in it, if it names one.
    pub fn of_children(&self, body: &Element<'a>) -> Result<Option<usize>> {
        self.find(body, "childclass")
    }

    /// The element with the defaults of its own class, or else of the one it stands in.
    pub fn apply(&self, element: Element<'a>, around: Option<usize>) -> Result<Element<'a>> {
        let main = self.classes.iter().rposition(|class| class.name == MAIN);
        let class = self.find(&element, "class")?.or(around).or(main);
        let up = |&index: &usize| self.classes[index].parent;
        let mut way: Vec<usize> = std::iter::successors(class, up).collect();
        way.reverse();
        let speaks = |other: &Element| {
            let both = [other.tag(), element.tag()];
            both[0] == both[1] || both.iter().all(|tag| ACTUATORS.contains(tag))
        };
        let children = way
            .iter()
            .flat_map(|&index| self.classes[index].element.children());
        let defaults: Vec<Element> = children.filter(speaks).collect();
        Ok(element.with_defaults(&defaults))
    }
}

fn grammar(tag: &str) -> Option<&'static Grammar> {
    match tag {
        "joint" => Some(&JOINT),
        "geom" => Some(&GEOM),
        "motor" => Some(&MOTOR),
        "position" => Some(&POSITION),
        _ => None,
    }
}
