#pragma once

namespace busbar {

/// The first member of a structure whose fields must be named: nothing converts to it, so that
/// `{.random = &random, .log = &log}` compiles and `{&random, &log}` does not. Takes no space.
struct NamedFields {
    explicit NamedFields() = default;
};

} // namespace busbar
