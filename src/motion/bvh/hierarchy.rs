//! The first half of a BVH file: the tree of joints and their channels.

use super::fault::{problem, shorten};
use super::number::number;
use super::text::is_comment;
use crate::motion::error::{MotionError, MotionResult};
use crate::motion::skeleton::Skeleton;
use glam::Vec3;
use std::collections::HashSet;
use std::path::Path;

/// No body has more joints; several steps behind this one compare each joint with each.
pub const MAX_JOINTS: usize = 4096;

/// One number a frame: a position along, or a rotation about, an axis (0, 1, 2 = x, y, z).
#[derive(Clone, Copy, PartialEq)]
pub enum Channel {
    Position(usize),
    Rotation(usize),
}

/// The tree and what each joint's numbers mean, joint by joint in the file's order.
pub struct Hierarchy {
    pub skeleton: Skeleton,
    pub channels: Vec<Vec<Channel>>,
    /// Line number (from 1) of the word MOTION.
    pub end: usize,
    /// Bytes of the text up to the end of that word.
    pub length: usize,
}

/// A brace that is still open.
#[derive(Clone, Copy)]
enum Block {
    Joint(usize),
    End { joint: usize, placed: bool },
}

/// Reads from HIERARCHY to MOTION. The open braces are a list, not a recursion, so that no
/// depth of nesting can exhaust the stack.
pub fn parse(text: &str, path: &Path) -> MotionResult<Hierarchy> {
    let mut reader = Reader {
        words: Words::new(text),
        path,
        open: Vec::new(),
        placed: Vec::new(),
        seen: HashSet::new(),
        skeleton: Skeleton {
            names: Vec::new(),
            parents: Vec::new(),
            offsets: Vec::new(),
            ends: Vec::new(),
        },
        channels: Vec::new(),
    };
    reader.start()?;
    while !reader.step()? {}
    Ok(Hierarchy {
        skeleton: reader.skeleton,
        channels: reader.channels,
        end: reader.words.line,
        length: text.len() - reader.words.rest.len(),
    })
}

struct Reader<'a> {
    words: Words<'a>,
    path: &'a Path,
    open: Vec<Block>,
    /// Which joints have had their OFFSET.
    placed: Vec<bool>,
    seen: HashSet<String>,
    skeleton: Skeleton,
    channels: Vec<Vec<Channel>>,
}

impl<'a> Reader<'a> {
    fn start(&mut self) -> MotionResult<()> {
        match self.words.statement() {
            Some(word) if word.eq_ignore_ascii_case("HIERARCHY") => Ok(()),
            Some("version") if self.words.rest.trim_start().starts_with("https://git-lfs") => {
                Err(self.fault("this is Git LFS's pointer to a recording; fetch the recording itself with `git lfs pull`"))
            }
            Some(word) => Err(self.fault(format!(
                "a BVH file begins with HIERARCHY, this one with '{}'; is it another kind of file?",
                shorten(word)
            ))),
            None => Err(self.fault("the file is empty")),
        }
    }

    /// Takes one statement; true after MOTION.
    fn step(&mut self) -> MotionResult<bool> {
        let Some(word) = self.words.statement() else {
            return Err(self.fault(format!(
                "the file ends inside the hierarchy, {} braces still open and no MOTION; it is truncated",
                self.open.len()
            )));
        };
        match (word.to_ascii_uppercase().as_str(), self.open.last().copied()) {
            ("ROOT", None) if self.skeleton.joints() > 0 => Err(self.fault(
                "a second ROOT: several characters in one file are not supported; export one file for each",
            )),
            ("ROOT", None) | ("JOINT", Some(Block::Joint(_))) => self.joint().map(|()| false),
            ("END" | "ENDSITE" | "END_SITE", Some(Block::Joint(joint))) => {
                self.end_site(joint).map(|()| false)
            }
            ("OFFSET", Some(block)) => self.offset(block).map(|()| false),
            ("CHANNELS", Some(Block::Joint(joint))) => self.take_channels(joint).map(|()| false),
            ("CHANNELS", Some(Block::End { .. })) => self.no_channels().map(|()| false),
            ("}", Some(block)) => self.close(block).map(|()| false),
            ("}", None) => Err(self.fault("'}' without a '{' before it; the braces do not balance")),
            ("MOTION", None) if self.skeleton.joints() > 0 => Ok(true),
            ("MOTION", None) => Err(self.fault("MOTION before any ROOT: the file has no joints")),
            ("MOTION", Some(_)) => Err(self.fault(format!(
                "MOTION while {} braces are still open; the braces do not balance",
                self.open.len()
            ))),
            (_, inside) => Err(self.fault(format!(
                "unexpected '{}'; here may stand {}",
                shorten(word),
                match inside {
                    None => "ROOT or MOTION",
                    Some(Block::Joint(_)) => "OFFSET, CHANNELS, JOINT, End Site or '}'",
                    Some(Block::End { .. }) => "OFFSET or '}'",
                }
            ))),
        }
    }

    fn joint(&mut self) -> MotionResult<()> {
        let name = self.words.name();
        if name.is_empty() {
            return Err(self.fault("a joint without a name"));
        }
        if !self.seen.insert(name.clone()) {
            return Err(self.fault(format!(
                "a second joint called '{}'; names tell joints apart, so rename one",
                shorten(&name)
            )));
        }
        if self.skeleton.joints() == MAX_JOINTS {
            return Err(self.fault(format!(
                "more than {MAX_JOINTS} joints; this is no skeleton of a body"
            )));
        }
        self.brace()?;
        let parent = match self.open.last() {
            Some(&Block::Joint(parent)) => Some(parent),
            _ => None,
        };
        self.open.push(Block::Joint(self.skeleton.joints()));
        self.skeleton.names.push(name);
        self.skeleton.parents.push(parent);
        self.skeleton.offsets.push(Vec3::ZERO);
        self.channels.push(Vec::new());
        self.placed.push(false);
        Ok(())
    }

    fn end_site(&mut self, joint: usize) -> MotionResult<()> {
        // "Site", or a name that some exporters write in its place.
        self.words.name();
        self.brace()?;
        self.open.push(Block::End {
            joint,
            placed: false,
        });
        Ok(())
    }

    fn brace(&mut self) -> MotionResult<()> {
        match self.words.next() {
            Some("{") => Ok(()),
            Some(word) => Err(self.fault(format!("expected '{{', found '{}'", shorten(word)))),
            None => Err(self.fault("expected '{', but the file ends here; it is truncated")),
        }
    }

    fn offset(&mut self, block: Block) -> MotionResult<()> {
        let offset = Vec3::new(self.number()?, self.number()?, self.number()?);
        match block {
            Block::Joint(joint) => {
                self.skeleton.offsets[joint] = offset;
                self.placed[joint] = true;
            }
            Block::End { joint, .. } => {
                self.skeleton.ends.push((joint, offset));
                self.open.pop();
                self.open.push(Block::End {
                    joint,
                    placed: true,
                });
            }
        }
        Ok(())
    }

    fn number(&mut self) -> MotionResult<f32> {
        match self.words.next() {
            Some(word) => number(self.path, self.words.line, word),
            None => Err(self.fault("expected a number, but the file ends here; it is truncated")),
        }
    }

    fn take_channels(&mut self, joint: usize) -> MotionResult<()> {
        if !self.channels[joint].is_empty() {
            return Err(self.fault("a second CHANNELS for one joint"));
        }
        for _ in 0..self.count()? {
            let channel = self.channel()?;
            let twice = self.channels[joint].contains(&channel);
            if twice && matches!(channel, Channel::Position(_)) {
                return Err(self.fault("one position channel twice in one joint"));
            }
            self.channels[joint].push(channel);
        }
        Ok(())
    }

    fn count(&mut self) -> MotionResult<usize> {
        let word = self.words.next().unwrap_or("");
        word.parse().map_err(|_| {
            self.fault(format!(
                "expected the number of channels, found '{}'",
                shorten(word)
            ))
        })
    }

    /// The `CHANNELS 0` that some programs give to an End Site too.
    fn no_channels(&mut self) -> MotionResult<()> {
        match self.count()? {
            0 => Ok(()),
            _ => Err(self.fault("an End Site with channels: only joints move; make it a JOINT")),
        }
    }

    fn channel(&mut self) -> MotionResult<Channel> {
        let Some(word) = self.words.next() else {
            return Err(self.fault("expected a channel, but the file ends here; it is truncated"));
        };
        match word.to_ascii_lowercase().as_str() {
            "xposition" => Ok(Channel::Position(0)),
            "yposition" => Ok(Channel::Position(1)),
            "zposition" => Ok(Channel::Position(2)),
            "xrotation" => Ok(Channel::Rotation(0)),
            "yrotation" => Ok(Channel::Rotation(1)),
            "zrotation" => Ok(Channel::Rotation(2)),
            _ => Err(self.fault(format!(
                "unknown channel '{}'; known are Xposition, Yposition, Zposition, Xrotation, Yrotation and Zrotation",
                shorten(word)
            ))),
        }
    }

    fn close(&mut self, block: Block) -> MotionResult<()> {
        let placed = match block {
            Block::Joint(joint) => self.placed[joint],
            Block::End { placed, .. } => placed,
        };
        if !placed {
            return Err(self.fault("a block closes without an OFFSET"));
        }
        self.open.pop();
        Ok(())
    }

    fn fault(&self, what: impl Into<String>) -> MotionError {
        problem(self.path, self.words.line, what)
    }
}

/// Words of a text, braces being words of their own, with the line of the last one taken.
struct Words<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        Words {
            rest: text,
            line: 1,
        }
    }

    fn next(&mut self) -> Option<&'a str> {
        let word = self.rest.trim_start();
        let skipped = &self.rest[..self.rest.len() - word.len()];
        self.line += skipped.matches('\n').count();
        let length = match word.chars().next()? {
            '{' | '}' => 1,
            _ => word
                .find(|c: char| c.is_whitespace() || c == '{' || c == '}')
                .unwrap_or(word.len()),
        };
        let (word, rest) = word.split_at(length);
        self.rest = rest;
        Some(word)
    }

    /// The next word that is no comment.
    fn statement(&mut self) -> Option<&'a str> {
        loop {
            let word = self.next()?;
            if !is_comment(word) {
                return Some(word);
            }
            self.rest = self.rest.find('\n').map_or("", |end| &self.rest[end..]);
        }
    }

    /// The rest of the line up to a brace: some programs put spaces in joint names, others quotes
    /// around them.
    fn name(&mut self) -> String {
        let length = self.rest.find(['\n', '{', '}']).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(length);
        self.rest = rest;
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
        let quoted = name
            .strip_prefix('"')
            .and_then(|name| name.strip_suffix('"'));
        quoted.map_or(name.clone(), str::to_string)
    }
}
