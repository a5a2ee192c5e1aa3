#include "value_carry.hpp"

#include "../retained/type_print.hpp"

namespace busbar::controller::detail {

std::vector<CarriedValue> carried_values(const LabelProgram& now, const LabelProgram& next)
{
    TypePrints prints_now{now.types()};
    TypePrints prints_next{next.types()};
    std::vector<CarriedValue> carried;
    for (const GlobalVariable& variable : next.types().program().variables) {
        const GlobalVariable* const before = now.variable(variable.name);
        const auto to = next.handle_of(variable);
        const auto from = before != nullptr ? now.handle_of(*before) : std::nullopt;
        if (!from || !to || before->is_constant || variable.is_constant ||
            prints_now.print(before->type) != prints_next.print(variable.type)) {
            continue;
        }
        server::ImageMemory& source = now.memory();
        server::ImageMemory& target = next.memory();
        const server::ImagePlace& place = target.layout()[*to];
        carried.push_back(
            {source.bytes(source.layout()[*from]), target.bytes(place), place.bytes()});
    }
    return carried;
}

} // namespace busbar::controller::detail
