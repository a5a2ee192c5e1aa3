#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/types/enumerations.hpp>

#include "extension_attributes.hpp"
#include "extension_xml.hpp"
#include "part_text.hpp"

namespace busbar::controller::detail {

/// Reads the mappings of nodes, one after another, from the XML that is kept for them.
class ExtensionReader {
public:
    ExtensionReader(std::string_view file, const ModelLimits& limits, ModelReports& reports)
        : file_{file}, limits_{limits}, reports_{reports}
    {
    }

    void read(const NodeId& node, NodeClass node_class, const std::string& xml, Mapping& to);

private:
    void read_extension(const pugi::xml_node& xml, Mapping& to);
    void read_mapping(const pugi::xml_node& xml, Mapping& to);
    void read_data(const pugi::xml_node& xml, Mapping& to);
    void read_method(const pugi::xml_node& xml, Mapping& to);
    void read_method_part(const pugi::xml_node& xml, MethodMapping& to);
    void read_handle(const pugi::xml_node& xml, MethodMapping& to);
    void read_input(const pugi::xml_node& xml, MethodMapping& to);
    void read_arguments(const pugi::xml_node& xml, std::vector<MappedPart>& to);
    void read_argument(const pugi::xml_node& xml, std::vector<MappedPart>& to);
    void read_additions(const pugi::xml_node& extension, Mapping& to);
    void read_addition(const pugi::xml_node& xml, DataMapping& to);
    void read_addition(const pugi::xml_node& xml, MethodMapping& to);
    void read_extensions(const pugi::xml_node& extensions, Mapping& to);
    [[nodiscard]] bool take_label(const pugi::xml_attribute& xml, std::string& to);
    void check_sign(const Mapping& mapping);

    [[nodiscard]] bool read_attributes(const pugi::xml_node& xml, ExtensionElement element,
                                       const PartPlace& place, PartAttributes& to);
    [[nodiscard]] bool read_attribute(const pugi::xml_attribute& xml, ExtensionElement element,
                                      const PartPlace& place, PartAttributes& to);
    void settle_specification(const PartPlace& place, ArraySpecification& specification);
    /// The kinds of part that an array or structure may have.
    struct Inside {
        std::size_t level{0};
        /// Number of enclosing elements of the same array.
        std::size_t dimension{0};
        bool allows_elements{false};
        bool allows_fields{false};
    };
    void read_parts(const pugi::xml_node& xml, const Inside& inside, const PartPlace& place,
                    MappedPart& to);
    void read_part(const pugi::xml_node& xml, const Inside& inside, const PartPlace& above,
                   MappedPart& to);
    void read_value(const pugi::xml_node& xml, std::size_t level, const PartPlace& place,
                    MappedPart& value);
    void drop_misplaced_label(const PartPlace& place, MappedPart& part);
    [[nodiscard]] bool has_only_elements(const pugi::xml_node& xml);

    void report(ModelCode code, const PartPlace& place, std::string_view found);
    /// Reports an error of the format, which discards the whole mapping.
    void break_format(ModelCode code, const PartPlace& place, std::string_view found)
    {
        report(code, place, found);
        keeps_format_ = false;
    }

    std::string_view file_;
    const ModelLimits& limits_;
    ModelReports& reports_;
    const NodeId* node_{nullptr};
    NodeClass node_class_{NodeClass::Unspecified};
    bool keeps_format_{true};
    std::size_t part_count_{0};
};

} // namespace busbar::controller::detail
