//! The English texts of the menu, of messages and of what is drawn over the picture, in one place, so that they can be
//! translated. Names of actions in braces stand for their keys. The names of actions and what they do stand in their
//! table, in `controls`; the panel and the benchmark, which are for engineers, keep their own texts. Names of lamps' colours and
//! motions stand with their values, in `world::placed`.

pub mod toasts;

/// The column of buttons.
pub mod column {
    pub const TITLE: &str = "grotto";
    pub const SUBTITLE: &str = "voxel caves in real light";
    pub const PAUSED: &str = "paused";
    pub const RESUME: &str = "Resume";
    pub const CONTINUE: &str = "Continue";
    pub const SAVES: &str = "Saves";
    pub const WORLDS: &str = "Worlds";
    pub const NEW_CAVE: &str = "New cave";
    pub const HOW_TO_PLAY: &str = "How to play";
    pub const SETTINGS: &str = "Settings";
    pub const KEYS: &str = "Keys";
    pub const TITLE_SCREEN: &str = "Title screen";
    pub const QUIT: &str = "Quit";
    pub const DROP: &str = "A world file (.ron) or a model (.vox) can be dropped on the window.";

    pub fn go_on_in(save: &str, since: &str) -> String {
        format!("Go on in {save}, {since}")
    }
}

/// The page of saves.
pub mod saves {
    pub const HEADING: &str = "Go on from a save";
    pub const NONE: &str = "There are no saves yet. What you dig and build is saved every minute, at the end, and by {save}.";
    pub const GO_ON: &str = "Go on";
    pub const COPY: &str = "Copy";
    pub const RENAME: &str = "Rename";
    pub const DELETE: &str = "Delete";
    pub const NEW_NAME: &str = "New name";
    pub const COPY_IT: &str = "Copy it";
    pub const RENAME_IT: &str = "Rename it";
    pub const DELETE_IT: &str = "Delete it";
    pub const KEEP_IT: &str = "Keep it";
    pub const LEAVE: &str = "Leave it";
    pub const PLAYED: &str = "It is being played";
    pub const DAMAGED: &str = "It cannot be read";
    pub const JUST_NOW: &str = "just now";

    pub fn about(world: &str, changes: &str) -> String {
        format!("in {world}, {changes}")
    }

    pub fn delete(save: &str) -> String {
        format!("Delete `{save}` and its backup for ever?")
    }

    pub fn deleted(save: &str) -> String {
        format!("`{save}` was deleted")
    }

    pub fn since(seconds: u64) -> String {
        match seconds {
            0..60 => JUST_NOW.to_owned(),
            60..3600 => format!("{} min ago", seconds / 60),
            3600..86_400 => format!("{} h ago", seconds / 3600),
            _ => format!("{} days ago", seconds / 86_400),
        }
    }
}

/// The page of worlds.
pub mod worlds {
    pub const HEADING: &str = "Choose a world";
    pub const NO_PICTURE: &str = "…";
}

/// The page of a new cave.
pub mod new_cave {
    pub const HEADING: &str = "New cave";
    pub const NAME: &str = "Name";
    pub const NAME_HINT: &str = "new cave";
    pub const SEED: &str = "Seed";
    pub const ANOTHER: &str = "another";
    pub const ROOMS: &str = "Size of rooms";
    pub const ROUGHNESS: &str = "Roughness";
    pub const MUSHROOMS: &str = "Mushrooms";
    pub const LAVA: &str = "Lava";
    pub const LAMPS: &str = "Lamps";
    pub const ENTER: &str = "Enter the cave";
}

/// The page that says how to play.
pub mod how_to_play {
    pub const HEADING: &str = "How to play";
    pub const ABOUT: &str = "Walk through the cave, dig and build; the light follows. Click into the picture to look around, \
         Esc opens this menu.";
}

/// The page of settings.
pub mod settings {
    pub const HEADING: &str = "Settings";
    pub const PICTURE: &str = "Picture";
    pub const BRIGHTNESS: &str = "Brightness (stops)";
    pub const FIELD_OF_VIEW: &str = "Field of view";
    pub const WORLDS_OWN: &str = "the world's own";
    pub const QUALITY: &str = "Quality";
    pub const HOLDS_FRAME_TIME: &str = "less where frames take too long";
    pub const SCALE: &str = "Resolution, as a share of the window's";
    pub const AUTOMATIC: &str = "automatic";
    pub const TEXTURES: &str = "Textures";
    pub const VSYNC: &str = "Wait for the screen (vsync)";
    pub const FRAME_LIMIT: &str = "Most frames a second";
    pub const NO_LIMIT: &str = "no limit";
    pub const UNFOCUSED_LIMIT: &str = "the same, while the window is not in use";
    pub const CONTROLS: &str = "Controls";
    pub const SENSITIVITY: &str = "Speed of the mouse";
    pub const INVERT: &str = "Mouse up looks down";
    pub const WINDOW: &str = "Window";
    pub const FULL_SCREEN: &str = "Full screen";
    pub const UI_SCALE: &str = "Size of letters and buttons";
    pub const SOUND: &str = "Sound";
    pub const VOLUME: &str = "Volume";
    pub const MUTED: &str = "Silent";
    pub const RESET: &str = "First settings again";
    pub const PANEL: &str =
        "Every parameter of the renderer is in the panel that {panel} opens while you play.";
}

/// The page of keys.
pub mod keys {
    pub const HEADING: &str = "Keys";
    pub const ABOUT: &str = "Click a key, then press what shall take its place, on the keyboard or the mouse. Esc leaves it, a right \
         click takes it away.";
    pub const PRESS: &str = "press a key …";
    pub const NONE: &str = "–";
    pub const RESET: &str = "↺";
    pub const RESET_HINT: &str = "The first keys of this action";
    pub const RESET_ALL: &str = "All first keys again";
    pub const NO_KEY: &str = "It has no key";
    pub const TAKE: &str = "Take it";
    pub const LEAVE: &str = "Leave it";

    pub fn taken(chord: &str, owner: &str, wanted: &str) -> String {
        format!("{chord} is the key of “{owner}”. Take it for “{wanted}”?")
    }

    pub fn cannot(chord: &str) -> String {
        format!("{chord} cannot be bound")
    }
}

/// What is said about keys that the file of settings gives.
pub mod bindings {
    pub fn no_key(text: &str, action: &str) -> String {
        format!("`{text}` cannot be a key of `{action}`")
    }

    pub fn kept(chord: &str, owner: &str, action: &str) -> String {
        format!("`{chord}` stays the key of `{owner}`, and `{action}` does not get it")
    }

    pub fn full(chord: &str, action: &str, most: usize) -> String {
        format!("`{action}` has {most} keys already: `{chord}` is left out")
    }
}

/// What is said about the file of settings.
pub mod settings_file {
    use std::path::Path;

    pub const NO_HOME: &str = "This user has no home folder: settings are not kept";
    pub const NEWER: &str = "The settings are of a newer grotto: what is changed here is not kept";
    pub const NO_TEXT: &str = "it is no text";

    pub fn unread(error: &str) -> String {
        format!("The settings are not read, nor kept. {error}")
    }

    pub fn note(note: &str) -> String {
        format!("settings: {note}")
    }

    pub fn set_aside(reason: &str, aside: &Path) -> String {
        format!(
            "The settings are damaged ({reason}), and are the first ones again. The file was set aside as {}",
            aside.display()
        )
    }

    pub fn not_set_aside(path: &Path, reason: &str, error: &str) -> String {
        format!(
            "{}: the settings are damaged ({reason}), and are the first ones again; the file cannot be set aside: {error}",
            path.display()
        )
    }

    pub fn wrong(name: &str, error: &str, before: &str) -> String {
        format!("`{name}`: {error}; it is {before}")
    }

    pub fn clamped(name: &str, [least, most]: [&str; 2], given: &str, clamped: &str) -> String {
        format!("`{name}` lies from {least} to {most}: {given} became {clamped}")
    }
}

/// Diagnostics that stay until they are closed.
pub mod diagnostics {
    pub const WORLD: &str = "The world file has an error; the last good world is shown";
    pub const SAVE: &str = "The save cannot be opened";
    pub const SHADERS: &str = "The shaders do not compile; the last good ones run";
}

/// What the player is told about the body.
pub mod body {
    pub const RETURNED: &str = "You fell out of the world, and are back where you last stood";
    pub const FREED: &str = "Voxels closed around you: you were moved out of them";
    pub const STUCK: &str = "Voxels closed around you and there is no room nearby: dig, or press {no_clip} to pass through";
    pub const WALKS: &str = "Walking: {up} jumps, {down} sneaks, {fly} flies";
    pub const FLIES: &str = "Flying: {up} rises, {down} sinks, {fly} walks";
    pub const PASSES: &str = "Passing through voxels: {no_clip} ends it";
    pub const NO_ROOM: &str = "There is no room here: fly out of the voxels first";
}

/// Why a lamp cannot be placed.
pub mod lamps {
    pub const INSIDE: &str = "There is no room for a lamp inside of a voxel";
    pub const OUTSIDE: &str = "Nothing can be placed outside of the world";
    pub const TAKEN: &str = "Something is in the place of the lamp already";
    pub const EYES: &str = "A lamp cannot be where your eyes are: step back";

    pub fn too_many(most: usize) -> String {
        format!("A world holds no more than {most} lamps")
    }
}

/// Bodies that a player makes of voxels, and voxels that they become again.
pub mod bodies {
    pub const EMPTY: &str = "There are no voxels to lift: mark a corner ({mark}) and aim at the opposite one, or aim at voxels with a brush";
    pub const VOXELS: &str =
        "The bodies of a world have no more voxels: set one into the world ({settle}) first";
    pub const NO_ROOM: &str = "There is no room for the body there";
    pub const NO_ROOM_TO_SET: &str =
        "There is no room for its voxels: push the body away from what is beside it";
    pub const NONE: &str = "You look at no body within reach: {lift} makes one";
    pub const NOT_FREE: &str = "This body moves by itself, or stands at an angle: it can be neither dug nor set into the world";
    pub const SET_FIRST: &str =
        "This is a body: {settle} sets it into the world, then it can be dug and built on";
    pub const IN_THE_WAY: &str = "A body is in the way: push it away, or set it into the world";
    pub const IN_A_MOMENT: &str = "The first body of a world takes a moment to appear";
    pub const PLAYER_IN_THE_WAY: &str = "You are in the way: step aside";

    pub fn too_large(size: &str, most: u32) -> String {
        format!(
            "These are {size} voxels. A body has at most {most} along an edge: mark a nearer corner"
        )
    }

    pub fn too_many(most: usize) -> String {
        format!(
            "A world holds no more than {most} bodies: set one into the world ({{settle}}) first"
        )
    }

    pub fn lifted(size: &str) -> String {
        format!(
            "A body of {size} voxels: walk against it to push it, {{settle}} sets it into the world, {{undo}} takes it back"
        )
    }

    pub fn settled(place: &str) -> String {
        format!("The body is part of the world again, at {place}")
    }
}

/// Brushes and copies, in words.
pub mod hands {
    pub const VOXEL: &str = "one voxel";
    pub const CORNER: &str = "box: aim at its other corner";

    pub fn ball(radius: f32) -> String {
        format!("ball of radius {radius}")
    }

    pub fn cube(edge: i32) -> String {
        format!("box of {edge} × {edge} × {edge}")
    }

    pub fn copy(size: &str, with_air: bool) -> String {
        let air = if with_air { " with air" } else { "" };
        format!("copy of {size}{air}")
    }
}

/// The inventory.
pub mod inventory {
    pub const HEADING: &str = "Inventory";
    pub const ABOUT: &str = "A click puts it into the selected slot; {inventory} or Esc closes";
    pub const MATERIALS: &str = "Materials";
    pub const LAMPS: &str = "Lamps";
    pub const KIND: &str = "kind";
    pub const POWER: &str = "power";
    pub const COLOUR: &str = "colour";
    pub const RADIUS: &str = "radius";
    pub const RADIUS_HINT: &str =
        "Smaller distances count as this one: how bright the lamp gets from near (voxels)";
    pub const SOFT: &str = "sphere";
    pub const SOFT_HINT: &str =
        "Radius of the sphere that shines: larger is softer shadows, 0 is a point (voxels)";
    pub const MOTION: &str = "motion";
    pub const TAKE: &str = "Take this lamp";
}

/// The readout.
pub mod readout {
    pub const AT: &str = "at";
    pub const LOOKS: &str = "looks";
    pub const AIMS_AT: &str = "aims at";
    pub const TIME: &str = "time";
    pub const PICTURE: &str = "picture";
    pub const QUALITY: &str = "quality";
    pub const PROBES: &str = "probes";
    pub const SOUND: &str = "sound";
    pub const HEARD: &str = "on";
    pub const NOTHING: &str = "nothing in reach";
    pub const LAMP_OFF: &str = ", off";
    pub const PAUSED: &str = ", paused";
}

/// Saving, while a run is played.
pub mod saving {
    pub const BUSY: &str = "The last save is still being written";

    pub fn no_home(variable: &str) -> String {
        format!("this user has no home folder: name a folder for saves by {variable}")
    }

    pub fn impossible(trouble: &str) -> String {
        format!("Nothing can be saved here: {trouble}")
    }
}
