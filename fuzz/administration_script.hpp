#pragma once

#include <optional>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/types/data_types.hpp>

#include "fuzz_script.hpp"

namespace busbar::fuzz {

/// A Method of administration and the Object that has it.
struct MethodTarget {
    NodeId object;
    NodeId method;
    std::vector<Argument> inputs;
    bool gives_handle{false};
};

/// The Method of that name below the Object; nothing if there is none.
[[nodiscard]] std::optional<MethodTarget> find_method(const model::AddressSpace& space,
                                                      model::NodeIndex object, const char* name);

/// A value of the argument's type; some are small so that handles and modes are met, texts are
/// names that mean something to a server of these targets, or bytes.
[[nodiscard]] Variant value_of(const Argument& argument, Script& script);

} // namespace busbar::fuzz
