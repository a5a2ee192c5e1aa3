#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <busbar/busbar.h>
#include <busbar/core/data_value.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/types.hpp>
#include <busbar/core/variant.hpp>

namespace busbar::c {

/// Memory that values of the C interface point into: texts of NodeIds, elements of arrays whose
/// form differs. Everything stays until clear().
class Scratch {
public:
    /// Returns room for `count` objects.
    template <typename T>
    [[nodiscard]] T* take(std::size_t count)
    {
        blocks_.push_back(std::make_unique<std::byte[]>(count == 0 ? 1 : count * sizeof(T)));
        return static_cast<T*>(static_cast<void*>(blocks_.back().get()));
    }
    /// Returns a copy that is terminated.
    [[nodiscard]] busbar_text keep(std::string_view text);
    void clear() { blocks_.clear(); }

private:
    std::vector<std::unique_ptr<std::byte[]>> blocks_;
};

/// Returns a copy of a value that a program made. Bad_InvalidArgument if it is malformed: an
/// unknown type, null where bytes or elements are expected, dimensions that are not those of its
/// elements, NodeIds that are none.
[[nodiscard]] Result<Variant> to_variant(const busbar_value& value);
/// Stores a value that points into `from` and `scratch`. Bad_NotSupported for a Variant, DataValue
/// or DiagnosticInfo in it, or a structure in XML, which leaves a null value.
StatusCode to_c(const Variant& from, Scratch& scratch, busbar_value& to);
/// Stores a DataValue likewise; a value that has no form in C makes its status Bad_NotSupported,
/// which is returned then.
StatusCode to_c(const DataValue& from, Scratch& scratch, busbar_data_value& to);
/// Reads a NodeId; Bad_NodeIdInvalid also for null.
[[nodiscard]] Result<NodeId> node_id_of(const char* text);
/// Returns the text of a string in C; null stays null.
[[nodiscard]] inline String string_of(const char* text)
{
    return text != nullptr ? String{text} : String{};
}

} // namespace busbar::c
