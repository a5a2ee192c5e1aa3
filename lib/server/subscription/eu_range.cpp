#include "eu_range.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

model::NodeIndex find_eu_range(const model::AddressSpace& space, model::NodeIndex variable)
{
    model::NodeIndex found = model::no_node;
    const QualifiedName name{0, "EURange"};
    space.for_each_child(variable, space.find(id::HasProperty), true, name,
                         [&](model::NodeIndex property) {
                             found = property;
                             return false;
                         });
    return found;
}

void EuRangeRead::start(const model::VariableAttributes& property, TimePoint now)
{
    call_.ask(0, property.source, {property.handle, nullptr});
    if (call_.start(*this, now, [](ReadPart&) {})) {
        call_completed();
    }
}

void EuRangeRead::call_completed()
{
    const ReadSlot& slot = call_.result(0);
    const Variant& value = slot.shared != nullptr ? *slot.shared : slot.value;
    user_->eu_range_came(slot.status.is_bad() ? std::nullopt : binary::structure_of<Range>(value));
}

} // namespace busbar::server::detail
