#pragma once

#include <memory>
#include <optional>
#include <string>

#include <busbar/controller/plc.hpp>

#include "plc_step.hpp"

namespace busbar::controller {

/// Makes a Plc of a PlcConfig, or says what is wrong with it.
class PlcBuilder {
public:
    explicit PlcBuilder(const PlcConfig& config) : config_{&config}, plc_{new Plc} {}

    [[nodiscard]] tl::expected<std::unique_ptr<Plc>, PlcConfigError>
    build(server::ImageOptions options);

private:
    using Checked = tl::expected<void, PlcConfigError>;
    using Part = PlcConfigError::Part;

    /// The variables of one PlcVariable.
    struct Group {
        std::uint32_t first;
        std::uint32_t count;
    };

    [[nodiscard]] Checked add_variables();
    [[nodiscard]] Checked add_variable(std::size_t index);
    [[nodiscard]] Checked check_names();
    [[nodiscard]] Checked set_values();
    [[nodiscard]] Checked add_programs();
    [[nodiscard]] Checked add_program(std::size_t index);
    [[nodiscard]] Checked add_events();
    [[nodiscard]] Checked check_event(std::size_t index) const;
    [[nodiscard]] Checked check_copy(std::size_t index, const Group& target);
    [[nodiscard]] std::optional<Group> find(std::string_view name) const;
    [[nodiscard]] static Checked error(Part part, std::size_t index, std::string field,
                                       std::string text);

    const PlcConfig* config_;
    std::unique_ptr<Plc> plc_;
    server::ImageLayout layout_;
    std::vector<Group> groups_;
};

} // namespace busbar::controller
