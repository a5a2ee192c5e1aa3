#pragma once

#include <functional>
#include <string>

#include <busbar/core/variant.hpp>

namespace busbar::administration {

/// A fact about a program's state, in addition to the Variables of the standard.
struct StatusFact {
    /// BrowseName, and a part of the NodeId: "Status/RestartDue".
    std::string name;
    /// A value of its type; an array for a fact that is always an array.
    Variant like;
    /// Called on the server's thread whenever a client reads it.
    std::function<Variant()> value;
};

} // namespace busbar::administration
