#pragma once

#include <memory>
#include <optional>
#include <string>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_config.hpp>
#include <busbar/core/problem.hpp>

#include "plc_names.hpp"
#include "plc_step.hpp"

namespace busbar::controller::detail {

/// Returns the variable's initial value with its type and dimensions; nothing if `variable.initial`
/// cannot be converted.
[[nodiscard]] std::optional<Variant> initial_value(const PlcVariable& variable);

} // namespace busbar::controller::detail

namespace busbar::controller {

/// Builds a Plc from a PlcConfig, or reports what is wrong with that.
class PlcBuilder {
public:
    explicit PlcBuilder(const PlcConfig& config) : config_{&config}, plc_{new Plc} {}

    [[nodiscard]] Configured<std::unique_ptr<Plc>> build(server::ImageOptions options);
    /// Builds it with the variables of a program instead of the configuration's.
    [[nodiscard]] Configured<std::unique_ptr<Plc>> build(const ProgramTypes& types,
                                                         const ProgramImage& image);

private:
    /// The variables that one PlcVariable stands for.
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
    /// Adds a program that may have `sets`.
    [[nodiscard]] Configured<void> add_setting(std::size_t index,
                                               const std::vector<detail::PlcPlace>& targets);
    [[nodiscard]] Configured<void> add_copy(std::size_t index,
                                            const std::vector<detail::PlcPlace>& targets);
    [[nodiscard]] Configured<std::unique_ptr<Plc>> finish();
    [[nodiscard]] std::vector<detail::PlcPlace> find(std::string_view name) const;
    [[nodiscard]] std::vector<detail::PlcPlace> find_restore_target();

    const PlcConfig* config_;
    std::unique_ptr<Plc> plc_;
    server::ImageLayout layout_;
    std::vector<Group> groups_;
    detail::PlcFinder finder_;
    /// That of restore_target_variable, which is not in the image.
    server::ImagePlace system_place_{};
};

} // namespace busbar::controller
