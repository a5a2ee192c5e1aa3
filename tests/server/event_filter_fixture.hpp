#pragma once

#include <memory>
#include <string>

#include "event_fixture.hpp"
#include "model/model_fixture.hpp"
#include "server/event/event_filter.hpp"

namespace busbar::server::detail {

using busbar::test::field;

/// Two event types of a vendor: AType with A, whose subtype has Values, and BType with B and an
/// object Part with a variable Code.
struct FilterFixture : model::ModelFixture {
    FilterFixture()
    {
        a_type = add_type("AType", space.find(id::BaseEventType));
        add_field("A", a_type, id::Int32, -1);
        sub_type = add_type("SubType", a_type);
        add_field("Values", sub_type, id::Double, 1);
        b_type = add_type("BType", space.find(id::BaseEventType));
        add_field("B", b_type, id::Int32, -1);
        add_field("State", b_type, id::StatusCode, -1);
        part = space.add_object(named("Part", b_type)).value();
        add_field("Code", part, id::String, -1);
    }

    model::NodeIndex add_type(const std::string& name, model::NodeIndex above)
    {
        return space.add_object_type(named(name, above)).value();
    }
    model::NodeIndex add_field(const std::string& name, model::NodeIndex parent, std::uint32_t type,
                               std::int32_t rank)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, type};
        variable.value_rank = rank;
        return space.add_property(named(name, parent), variable).value();
    }
    [[nodiscard]] QualifiedName own(const char* name) const { return {ns, name}; }
    [[nodiscard]] NodeId own_id(const char* name) const { return {ns, String{name}}; }
    [[nodiscard]] SimpleAttributeOperand own_field(const char* name) const
    {
        return field({own(name)});
    }

    StatusCode compile(const EventFilter& filter)
    {
        compiled = CompiledEventFilter{};
        result = EventFilterResult{};
        return compiled.compile(filter, fields, limits, result);
    }
    StatusCode select_status(const SimpleAttributeOperand& operand)
    {
        EventFilter filter;
        filter.select_clauses.push_back(operand);
        REQUIRE(compile(filter) == status::Good);
        return result.select_clause_results.empty() ? status::Good
                                                    : result.select_clause_results[0];
    }
    [[nodiscard]] std::unique_ptr<RaisedEvent> raise(Event event) const
    {
        const model::NodeIndex type = space.find(event.event_type);
        return std::make_unique<RaisedEvent>(std::move(event), type, ByteString{},
                                             Received{DateTime::from_unix_seconds(9)});
    }
    bool passes(const EventFilter& filter, Event event)
    {
        REQUIRE(compile(filter) == status::Good);
        return compiled.matches(*raise(std::move(event)), space);
    }
    [[nodiscard]] Event event_of(const char* type) const
    {
        Event event;
        event.event_type = own_id(type);
        return event;
    }

    model::NodeIndex a_type, sub_type, b_type, part;
    EventFields fields{space};
    EventFilterLimits limits;
    CompiledEventFilter compiled;
    EventFilterResult result;
};

} // namespace busbar::server::detail
