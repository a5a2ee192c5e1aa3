#include "commands.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/server/conformance.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "tool/connection/connection.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

struct Claims {
    std::vector<std::string> profiles;
    std::vector<std::string> units;
};

Claims read_claims(Connection& connection)
{
    ReadRequest request;
    for (const std::uint32_t variable : {id::Server_ServerCapabilities_ServerProfileArray,
                                         id::Server_ServerCapabilities_ConformanceUnits}) {
        ReadValueId& value = request.nodes_to_read.emplace_back();
        value.node_id = NodeId{0, variable};
        value.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    const auto response =
        connection.call<ReadResponse>(std::move(request), "reading what it claims");
    Claims claims;
    if (response.results.size() != 2) {
        return claims;
    }
    if (const auto* const profiles = response.results[0].value.array_if<String>()) {
        for (const String& uri : *profiles) {
            claims.profiles.push_back(uri.str());
        }
    }
    // Absent in servers before 1.05, which have no such Variable.
    if (const auto* const units = response.results[1].value.array_if<QualifiedName>()) {
        for (const QualifiedName& unit : *units) {
            claims.units.push_back(unit.name.str());
        }
    }
    return claims;
}

bool has(const std::vector<std::string>& texts, std::string_view text)
{
    return std::find(texts.begin(), texts.end(), text) != texts.end();
}

std::vector<server::ProfileAssessment> assess(const Claims& claims)
{
    std::vector<std::string_view> units{claims.units.begin(), claims.units.end()};
    std::vector<server::ProfileAssessment> all = server::assess_units(units).profiles;
    std::erase_if(all, [](const server::ProfileAssessment& each) { return each.is_client; });
    return all;
}

std::string json_of(const Claims& claims)
{
    JsonLine json;
    const auto list = [&](std::string_view name, const std::vector<std::string>& texts) {
        json.key(name).open_array();
        for (const std::string& text : texts) {
            json.text(text);
        }
        json.close_array();
    };
    json.open_object();
    list("serverProfileArray", claims.profiles);
    list("conformanceUnits", claims.units);
    json.key("profiles").open_array();
    for (const server::ProfileAssessment& profile : assess(claims)) {
        json.open_object();
        json.member("name", profile.name).member("uri", profile.uri);
        json.member("claimed", has(claims.profiles, profile.uri));
        json.key("lacks").open_array();
        for (const server::UnitLack& lack : profile.lacks) {
            json.text(lack.unit);
        }
        json.close_array().close_object();
    }
    return json.close_array().close_object().document();
}

void print(Output& out, const Claims& claims)
{
    if (claims.profiles.empty() && claims.units.empty()) {
        out.line("The server does not say what it conforms to.");
        return;
    }
    Table table{{{"PROFILE"}, {"CLAIMED"}, {"UNITS THAT ARE NOT NAMED", 24}}};
    for (const server::ProfileAssessment& profile : assess(claims)) {
        const bool is_claimed = has(claims.profiles, profile.uri);
        std::string lacks;
        for (const server::UnitLack& lack : profile.lacks) {
            lacks += (lacks.empty() ? "" : "; ") + std::string{lack.unit};
        }
        table.add({{std::string{profile.name}},
                   {is_claimed ? "yes" : "no", is_claimed ? Style::Good : Style::Dim},
                   {claims.units.empty() ? "-" : lacks}});
    }
    table.print(out);
    for (const std::string& uri : claims.profiles) {
        const auto all = assess(claims);
        if (std::none_of(all.begin(), all.end(),
                         [&](const auto& each) { return each.uri == uri; })) {
            out.line("also claimed: " + safe(uri));
        }
    }
}

} // namespace

Exit show_claims(Context& context)
{
    Connection connection{context};
    const Claims claims = read_claims(connection);
    if (context.options.is_json) {
        context.out.line(json_of(claims));
    } else {
        print(context.out, claims);
    }
    return Exit::Good;
}

} // namespace busbar::tool
