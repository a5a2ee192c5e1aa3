#pragma once

#include <functional>
#include <string>

#include <busbar/core/variant.hpp>

namespace busbar::administration {

/// What a program says of how it is, beyond what the standard has Variables for.
struct StatusFact {
    /// BrowseName, and a part of the NodeId: "Status/RestartDue".
    std::string name;
    /// A value of its type; an array for one that is always an array.
    Variant like;
    /// Called on the server's thread whenever a client asks.
    std::function<Variant()> value;
};

} // namespace busbar::administration
