#pragma once

#include <memory>
#include <optional>
#include <string>

#include <busbar/controller/plc.hpp>
#include <busbar/core/problem.hpp>

#include "plc_step.hpp"

namespace busbar::controller {

/// Makes a Plc of a PlcConfig, or says what is wrong with it.
class PlcBuilder {
public:
    explicit PlcBuilder(const PlcConfig& config) : config_{&config}, plc_{new Plc} {}

    [[nodiscard]] Configured<std::unique_ptr<Plc>> build(server::ImageOptions options);

private:
    /// The variables of one PlcVariable.
    struct Group {
        std::uint32_t first;
        std::uint32_t count;
    };

    [[nodiscard]] Configured<void> add_variables();
    [[nodiscard]] Configured<void> add_variable(std::size_t index);
    [[nodiscard]] Configured<void> check_names();
    [[nodiscard]] Configured<void> set_values();
    [[nodiscard]] Configured<void> add_programs();
    [[nodiscard]] Configured<void> add_program(std::size_t index);
    [[nodiscard]] Configured<void> add_events();
    [[nodiscard]] Configured<void> check_event(std::size_t index) const;
    [[nodiscard]] Configured<void> check_copy(std::size_t index, const Group& target);
    [[nodiscard]] std::optional<Group> find(std::string_view name) const;
    [[nodiscard]] detail::PlcTarget target_of(std::uint32_t handle);

    const PlcConfig* config_;
    std::unique_ptr<Plc> plc_;
    server::ImageLayout layout_;
    std::vector<Group> groups_;
};

} // namespace busbar::controller
