#pragma once

namespace busbar {

/// The first member of a structure whose fields are to be named: nothing converts to it, so that
/// `{.random = &random, .log = &log}` compiles and `{&random, &log}` does not. Takes no room.
struct NamedFields {
    explicit NamedFields() = default;
};

} // namespace busbar
