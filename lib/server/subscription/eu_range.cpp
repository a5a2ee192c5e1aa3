#include "eu_range.hpp"

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
    const auto* const object = value.get_if<ExtensionObject>();
    const Range* const range = object != nullptr ? object->get_if<Range>() : nullptr;
    const bool is_there = range != nullptr && !slot.status.is_bad();
    user_->eu_range_came(is_there ? std::optional{*range} : std::nullopt);
}

} // namespace busbar::server::detail
