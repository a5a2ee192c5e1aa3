#include <optional>
#include <string_view>
#include <vector>

#include "controller/program/declaration_cursor.hpp"
#include "controller/program/declaration_keywords.hpp"
#include "controller/program/literal.hpp"
#include "plcopen_reader.hpp"

namespace busbar::controller::detail {

namespace {

/// Concatenates the texts of all elements, at any depth.
class TextCollector : public pugi::xml_tree_walker {
public:
    bool for_each(pugi::xml_node& node) override
    {
        if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
            const std::string_view text = trimmed_text(node.value());
            text_ += text_.empty() || text.empty() ? "" : " ";
            text_ += text;
        }
        return true;
    }
    [[nodiscard]] std::string& text() { return text_; }

private:
    std::string text_{};
};

/// Returns where Sysmac Studio says how a variable is published.
pugi::xml_node properties_of(const pugi::xml_node& data)
{
    return child_of(data, "GlobalVariableAdditionalProperties");
}

/// Returns each <data> that says how the element is published.
std::vector<pugi::xml_node> publish_data_of(const pugi::xml_node& xml)
{
    std::vector<pugi::xml_node> all;
    for (const pugi::xml_node& data : child_of(xml, "addData").children()) {
        if (std::string_view{data.attribute("name").value()} == plcopen_publish_data ||
            properties_of(data).attribute("networkPublish")) {
            all.push_back(data);
        }
    }
    return all;
}

std::optional<NetworkPublish> publish_in(const pugi::xml_node& data)
{
    const pugi::xml_attribute property = properties_of(data).attribute("networkPublish");
    return publish_of(
        trimmed_text(property ? property.value() : child_of(data, "publish").text().get()));
}

} // namespace

bool PlcopenReader::read_variables(const pugi::xml_node& xml)
{
    GlobalVariable common;
    bool is_persistent = false;
    if (!read_flag(xml, "constant", common.is_constant) ||
        !read_flag(xml, "retain", common.is_retained) ||
        !read_flag(xml, "persistent", is_persistent) || !read_publish(xml, common.publish)) {
        return false;
    }
    common.is_retained = common.is_retained || is_persistent;
    pass_->constants.set_list(xml.attribute("name").value());
    for (const pugi::xml_node& child : xml.children()) {
        if (is_named(child, "variable") && !read_variable(child, common) &&
            !leave_out(child, LeftOut::Kind::Variable,
                       publish_of_variable(child, common.publish))) {
            return false;
        }
    }
    return true;
}

bool PlcopenReader::read_variable(const pugi::xml_node& xml, GlobalVariable variable)
{
    variable.place = place_of(xml);
    if (!keep(xml, sizeof variable) || !read_address(xml, variable.address) ||
        !read_name(xml, "name", variable.name)) {
        return false;
    }
    path_ = variable.name;
    if (!read_use(xml, "type", variable.type) || !read_initial(xml, variable.initial) ||
        (variable.is_constant && !add_constant(xml, variable)) ||
        !read_publish(xml, variable.publish) || !read_documentation(xml, variable.comment)) {
        return false;
    }
    pass_->program.variables.push_back(std::move(variable));
    return true;
}

bool PlcopenReader::add_constant(const pugi::xml_node& xml, const GlobalVariable& variable)
{
    const pugi::xml_node value = child_of(child_of(xml, "initialValue"), "simpleValue");
    pass_->constants.add_constant(
        {.name = variable.name, .text = value.attribute("value").value(), .place = variable.place},
        variable.type);
    return keep(xml, ConstantTable::memory_of_one);
}

bool PlcopenReader::read_address(const pugi::xml_node& xml, std::string& address)
{
    const pugi::xml_node holder = child_of(xml, "address");
    const std::string_view text = (holder ? holder : xml).attribute("address").value();
    // IEC 61131-10 is from tools with addresses of their own: %W461.00, IOBus://rack#0.
    if (!text.empty() && !holder && !is_direct_address(text)) {
        return fail(xml, "in <variable>: " + found_expected(text, "an address as %IX0.0"));
    }
    address = text.substr(0, limits_->max_name_length);
    return keep(xml, address.size());
}

NetworkPublish PlcopenReader::publish_of_variable(const pugi::xml_node& xml, NetworkPublish common)
{
    for (const pugi::xml_node& data : publish_data_of(xml)) {
        common = publish_in(data).value_or(common);
    }
    return common;
}

bool PlcopenReader::read_publish(const pugi::xml_node& xml, NetworkPublish& publish)
{
    for (const pugi::xml_node& data : publish_data_of(xml)) {
        const auto found = publish_in(data);
        if (!found) {
            return fail(data, "found a publish attribute that is not known, expected <publish> "
                              "with none, publish only, input or output");
        }
        publish = *found;
    }
    return true;
}

bool PlcopenReader::read_flag(const pugi::xml_node& xml, const char* name, bool& flag)
{
    const std::string_view text = xml.attribute(name).value();
    flag = text == "true" || text == "1";
    return flag || text.empty() || text == "false" || text == "0" ||
           fail(xml,
                "in " + tag_of(xml) + ": " +
                    found_expected(text, std::string{"true or false as the attribute "} + name));
}

bool PlcopenReader::read_initial(const pugi::xml_node& xml, InitialValue& initial)
{
    const pugi::xml_node holder = child_of(xml, "initialValue");
    return !holder || read_value(holder, initial, 0);
}

bool PlcopenReader::read_value(const pugi::xml_node& holder, InitialValue& value, std::size_t depth)
{
    const pugi::xml_node xml = first_element_of(holder);
    value.place = place_of(xml ? xml : holder);
    if (depth > limits_->max_depth) {
        return fail(holder,
                    "has more than " + std::to_string(limits_->max_depth) + " values around it");
    }
    const bool is_list = is_named(xml, "arrayValue");
    if (is_list || is_named(xml, "structValue")) {
        return read_parts(xml, value, is_list, depth);
    }
    if (!is_named(xml, "simpleValue")) {
        return fail(xml ? xml : holder, "found " + tag_of(xml ? xml : holder) +
                                            ", expected <simpleValue>, <arrayValue> or "
                                            "<structValue>");
    }
    DeclarationCursor cursor{xml.attribute("value").value(),
                             source_->file,
                             nullptr,
                             *limits_,
                             pass_->memory,
                             pass_->constants};
    const ProgramPlace place = value.place;
    if (!read_initial_value(cursor, value) ||
        !(cursor.is_end() || cursor.fail("the end of the value"))) {
        return fail(xml, "in <simpleValue>: " + cursor.problem().text);
    }
    value.place = place;
    return true;
}

bool PlcopenReader::read_parts(const pugi::xml_node& xml, InitialValue& value, bool is_list,
                               std::size_t depth)
{
    for (const pugi::xml_node& child : xml.children()) {
        if (!is_named(child, "value")) {
            continue;
        }
        InitialValue part;
        std::int64_t repeat = 1;
        if (!keep(child, sizeof part) || (!is_list && !read_name(child, "member", part.member)) ||
            (is_list && child.attribute("repetitionValue") &&
             !read_number(child, "repetitionValue", repeat)) ||
            !read_value(child, part, depth + 1)) {
            return false;
        }
        if (repeat < 1 || repeat > INT32_MAX) {
            return fail(child, "found the repetitionValue " + std::to_string(repeat) +
                                   ", expected one from 1 on");
        }
        part.repeat = static_cast<std::uint32_t>(repeat);
        value.parts.push_back(std::move(part));
    }
    return true;
}

bool PlcopenReader::read_documentation(const pugi::xml_node& xml, std::string& comment)
{
    TextCollector collector;
    pugi::xml_node documentation = child_of(xml, "documentation");
    documentation.traverse(collector);
    comment = std::move(collector.text());
    return keep(xml, comment.size());
}

} // namespace busbar::controller::detail
