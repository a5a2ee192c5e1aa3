#pragma once

#include <string>

#include <busbar/client/value_text.hpp>

#include "tool/connection/connection.hpp"

namespace busbar::tool {

/// A client::ValueType with what its `type` lives in.
struct TypeOfValue {
    BuiltInType built_in;
    std::int32_t value_rank;
    const binary::DynamicType* type;
    Types types;
};

/// Determines how to parse a text as a value of this DataType and ValueRank; asks the server for
/// types that are not built in.
[[nodiscard]] TypeOfValue value_type(Connection& connection, const NodeId& data_type,
                                     std::int32_t value_rank);
/// The same with the types that are known; Variant for any other type.
[[nodiscard]] TypeOfValue value_type(Types types, const NodeId& data_type, std::int32_t value_rank);
/// A built-in type by its name; throws Failure. `value_rank` as above.
[[nodiscard]] TypeOfValue value_type(const std::string& name, std::int32_t value_rank);
/// Reads `text`; throws Failure, which says that `what` is wrong.
/// A structure has the fields of `base`, which may be null, where the text does not name them.
[[nodiscard]] Variant parse_value(const std::string& text, const TypeOfValue& type,
                                  const std::string& what, const Variant* base = nullptr);

} // namespace busbar::tool
