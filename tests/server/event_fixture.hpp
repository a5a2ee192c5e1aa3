#pragma once

#include <initializer_list>
#include <utility>

#include <busbar/server/event.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

/// Filters as a client writes them.
namespace busbar::test {

inline SimpleAttributeOperand field(std::initializer_list<QualifiedName> path,
                                    NodeId type = NodeId{0, id::BaseEventType})
{
    SimpleAttributeOperand operand;
    operand.type_definition_id = std::move(type);
    operand.browse_path = Array<QualifiedName>(path);
    operand.attribute_id = 13;
    return operand;
}

inline SimpleAttributeOperand field(const char* name)
{
    return field({QualifiedName{0, name}});
}

inline ExtensionObject literal(Variant value)
{
    LiteralOperand operand;
    operand.value = std::move(value);
    return ExtensionObject::from(std::move(operand));
}

inline ExtensionObject element(std::uint32_t index)
{
    ElementOperand operand;
    operand.index = index;
    return ExtensionObject::from(operand);
}

inline ExtensionObject of(SimpleAttributeOperand operand)
{
    return ExtensionObject::from(std::move(operand));
}

inline ExtensionObject of(const char* name)
{
    return of(field(name));
}

/// Adds an element to the filter's whereClause.
inline void where(EventFilter& filter, FilterOperator id,
                  std::initializer_list<ExtensionObject> operands)
{
    ContentFilterElement added;
    added.filter_operator = id;
    added.filter_operands = Array<ExtensionObject>(operands);
    filter.where_clause.elements.push_back(std::move(added));
}

inline EventFilter selecting(std::initializer_list<const char*> names)
{
    EventFilter filter;
    for (const char* name : names) {
        filter.select_clauses.push_back(field(name));
    }
    return filter;
}

} // namespace busbar::test
