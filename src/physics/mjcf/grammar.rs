//! What an element may have: attributes that are read, attributes that cannot change the dynamics,
//! attributes that are accepted with the value that changes nothing, and elements within.

pub struct Grammar {
    read: &'static [&'static str],
    ignored: &'static [&'static str],
    fixed: &'static [(&'static str, &'static [&'static str])],
    pub within: &'static [&'static str],
}

const NOTHING: Grammar = Grammar {
    read: &[],
    ignored: &[],
    fixed: &[],
    within: &[],
};

impl Grammar {
    pub fn knows(&self, name: &str) -> bool {
        self.read.contains(&name) || self.ignored.contains(&name) || self.only(name).is_some()
    }

    /// The values an attribute must have, if it is one that must keep them.
    pub fn only(&self, name: &str) -> Option<&'static [&'static str]> {
        let fixed = self.fixed.iter().find(|(known, _)| *known == name);
        fixed.map(|(_, values)| *values)
    }
}

pub const MUJOCO: Grammar = Grammar {
    read: &["model"],
    within: &[
        "actuator",
        "asset",
        "compiler",
        "contact",
        "custom",
        "default",
        "equality",
        "keyframe",
        "option",
        "sensor",
        "size",
        "statistic",
        "tendon",
        "visual",
        "worldbody",
    ],
    ..NOTHING
};

pub const COMPILER: Grammar = Grammar {
    read: &["angle", "autolimits", "inertiafromgeom"],
    ignored: &[
        "assetdir",
        "discardvisual",
        "exactmeshinertia",
        "fitaabb",
        "meshdir",
        "saveinertial",
        "strippath",
        "texturedir",
        "usethread",
    ],
    fixed: &[
        ("alignfree", &["false"]),
        ("balanceinertia", &["false"]),
        ("boundinertia", &["0"]),
        ("boundmass", &["0"]),
        ("coordinate", &["local"]),
        ("eulerseq", &["xyz"]),
        ("fusestatic", &["false"]),
        ("inertiagrouprange", &["0 5"]),
        ("settotalmass", &["-1"]),
    ],
    within: &["lengthrange"],
};

/// The simulator has a time step, a solver and an integrator of its own.
pub const OPTION: Grammar = Grammar {
    ignored: &[
        "timestep",
        "iterations",
        "tolerance",
        "ls_iterations",
        "ls_tolerance",
        "ccd_iterations",
        "ccd_tolerance",
        "sdf_iterations",
        "sdf_initpoints",
        "solver",
        "integrator",
        "jacobian",
        "magnetic",
        "apirate",
    ],
    fixed: &[
        ("gravity", &["0 0 -9.81"]),
        ("wind", &["0 0 0"]),
        ("density", &["0"]),
        ("viscosity", &["0"]),
        ("impratio", &["1"]),
        ("cone", &["pyramidal"]),
        ("noslip_iterations", &["0"]),
    ],
    within: &["flag"],
    ..NOTHING
};

pub const FLAG: Grammar = Grammar {
    ignored: &[
        "warmstart",
        "energy",
        "fwdinv",
        "invdiscrete",
        "multiccd",
        "nativeccd",
        "island",
        "sensor",
        "midphase",
        "autoreset",
        "eulerdamp",
    ],
    fixed: &[
        ("constraint", &["enable"]),
        ("equality", &["enable"]),
        ("frictionloss", &["enable"]),
        ("limit", &["enable"]),
        ("contact", &["enable"]),
        ("spring", &["enable"]),
        ("damper", &["enable"]),
        ("gravity", &["enable"]),
        ("clampctrl", &["enable"]),
        ("filterparent", &["enable"]),
        ("actuation", &["enable"]),
        ("refsafe", &["enable"]),
        ("override", &["disable"]),
    ],
    ..NOTHING
};

pub const CLASS: Grammar = Grammar {
    read: &["class"],
    // Of those that are not read, nothing that uses them is.
    within: &[
        "default", "joint", "geom", "general", "motor", "position", "camera", "equality", "light",
        "material", "mesh", "pair", "site", "tendon",
    ],
    ..NOTHING
};

pub const WORLD: Grammar = Grammar {
    within: &["body", "frame", "geom", "camera", "light", "site"],
    ..NOTHING
};

pub const FRAME: Grammar = Grammar {
    read: &[
        "name",
        "childclass",
        "pos",
        "quat",
        "axisangle",
        "xyaxes",
        "zaxis",
        "euler",
    ],
    within: &[
        "body",
        "frame",
        "joint",
        "freejoint",
        "inertial",
        "geom",
        "camera",
        "light",
        "site",
    ],
    ..NOTHING
};

pub const ACTUATOR: Grammar = Grammar {
    within: &["general", "motor", "position"],
    ..NOTHING
};

pub const CONTACT: Grammar = Grammar {
    within: &["exclude"],
    ..NOTHING
};

pub const BODY: Grammar = Grammar {
    read: &[
        "name",
        "childclass",
        "pos",
        "quat",
        "axisangle",
        "xyaxes",
        "zaxis",
        "euler",
    ],
    ignored: &["user"],
    fixed: &[
        ("mocap", &["false"]),
        ("gravcomp", &["0"]),
        ("sleep", &["auto"]),
    ],
    within: FRAME.within,
};

pub const INERTIAL: Grammar = Grammar {
    read: &[
        "pos",
        "quat",
        "axisangle",
        "xyaxes",
        "zaxis",
        "euler",
        "mass",
        "diaginertia",
        "fullinertia",
    ],
    ..NOTHING
};

pub const FREE_JOINT: Grammar = Grammar {
    read: &["name"],
    ignored: &["group"],
    fixed: &[("align", &["false", "auto"])],
    ..NOTHING
};

pub const JOINT: Grammar = Grammar {
    read: &[
        "name",
        "class",
        "type",
        "pos",
        "axis",
        "range",
        "limited",
        "armature",
        "stiffness",
        "damping",
        "springref",
        "margin",
        "actuatorfrcrange",
        "actuatorfrclimited",
        "solreflimit",
        "solimplimit",
    ],
    ignored: &["group", "user", "solreffriction", "solimpfriction"],
    fixed: &[
        ("actuatorgravcomp", &["false"]),
        ("frictionloss", &["0"]),
        ("ref", &["0"]),
        ("springdamper", &["0 0"]),
    ],
    ..NOTHING
};

pub const GEOM: Grammar = Grammar {
    read: &[
        "name",
        "class",
        "type",
        "size",
        "fromto",
        "pos",
        "quat",
        "axisangle",
        "xyaxes",
        "zaxis",
        "euler",
        "mass",
        "density",
        "friction",
        "condim",
        "solref",
        "solimp",
        "contype",
        "conaffinity",
        "mesh",
    ],
    ignored: &["group", "user", "rgba", "material", "fluidcoef", "fitscale"],
    fixed: &[
        ("fluidshape", &["none"]),
        ("gap", &["0"]),
        ("margin", &["0"]),
        ("priority", &["0"]),
        ("shellinertia", &["false"]),
        ("solmix", &["1"]),
    ],
    ..NOTHING
};

pub const POSITION: Grammar = Grammar {
    read: &[
        "name",
        "class",
        "joint",
        "gear",
        "kp",
        "kv",
        "inheritrange",
        "ctrlrange",
        "ctrllimited",
        "forcerange",
        "forcelimited",
    ],
    ignored: &["group", "user", "lengthrange", "cranklength"],
    fixed: &[("dampratio", &["0"]), ("timeconst", &["0"])],
    ..NOTHING
};

pub const MOTOR: Grammar = Grammar {
    read: &[
        "name",
        "class",
        "joint",
        "gear",
        "ctrlrange",
        "ctrllimited",
        "forcerange",
        "forcelimited",
    ],
    ignored: &["group", "user", "lengthrange", "cranklength"],
    ..NOTHING
};

pub const GENERAL: Grammar = Grammar {
    read: &[
        "name",
        "class",
        "joint",
        "gear",
        "gainprm",
        "biastype",
        "biasprm",
        "ctrlrange",
        "ctrllimited",
        "forcerange",
        "forcelimited",
    ],
    ignored: &["group", "user", "lengthrange", "cranklength", "dynprm"],
    fixed: &[
        ("actlimited", &["false", "auto"]),
        ("dyntype", &["none"]),
        ("gaintype", &["fixed"]),
    ],
    ..NOTHING
};

pub const TENDONS: Grammar = Grammar {
    within: &["fixed", "spatial"],
    ..NOTHING
};

/// A tendon that pulls at nothing: it measures.
pub const TENDON: Grammar = Grammar {
    read: &["name", "class", "limited", "range"],
    ignored: &[
        "group",
        "user",
        "material",
        "rgba",
        "width",
        "springlength",
        "margin",
        "solreflimit",
        "solimplimit",
        "solreffriction",
        "solimpfriction",
    ],
    fixed: &[
        ("armature", &["0"]),
        ("damping", &["0"]),
        ("frictionloss", &["0"]),
        ("stiffness", &["0"]),
    ],
    within: &["joint", "site", "geom", "pulley"],
};

pub const EXCLUDE: Grammar = Grammar {
    read: &["name", "body1", "body2"],
    ..NOTHING
};
