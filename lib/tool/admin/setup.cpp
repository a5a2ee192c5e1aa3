#include <cstdint>
#include <optional>
#include <string>

#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/connection/credentials.hpp"
#include "tool/connection/logs.hpp"
#include "tool/connection/pki.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool::admin {

namespace {

/// False if the server already has it.
template <typename Function>
bool unless_there(Function&& function)
{
    try {
        function();
        return true;
    } catch (const Failure& failure) {
        if (failure.status != status::Bad_EntryExists &&
            failure.status != status::Bad_AlreadyExists) {
            throw;
        }
        return false;
    }
}

/// Trusts our certificate permanently, before the setup ends and untrusted clients are refused
/// again.
void trust_us(Context& context, Connection& connection)
{
    VerboseLog log{context.options.is_verbose};
    Pki pki{context.options, log};
    const auto own = pki.own();
    if (!own) {
        return;
    }
    const TrustListNodes nodes = trust_list(connection, false);
    unless_there([&] {
        call(connection, nodes.object, nodes.add,
             {Variant{ByteString{own->certificates.front().der()}}, Variant{true}},
             "trusting our certificate");
    });
}

/// Adds the user. An interrupted setup has left the user without the role of an administrator; then
/// only the password changes.
void add_or_change(Connection& connection, const std::string& name, const crypto::Secret& password,
                   const std::string& description)
{
    const bool is_added =
        unless_there([&] { add_user(connection, name, password, std::uint32_t{0}, description); });
    if (!is_added) {
        change_user(connection, name, &password, std::nullopt);
    }
}

Exit set_up(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& name = arguments.words.front();
    const crypto::Secret password = new_password(context, name, arguments.new_password_file);
    trust_us(context, connection);
    add_or_change(connection, name, password, arguments.description);
    // The first role lets the user write variables; the last one makes an administrator, which ends
    // the setup.
    for (const std::uint32_t role : {id::WellKnownRole_Operator, id::WellKnownRole_ConfigureAdmin,
                                     id::WellKnownRole_SecurityAdmin}) {
        const IdentityMappingRuleType rule{IdentityCriteriaType::UserName, String{name}};
        unless_there([&] {
            call(connection, standard(role), child_of(connection, standard(role), "AddIdentity"),
                 {Variant{ExtensionObject::from(rule)}}, "giving " + safe(name) + " the roles");
        });
    }
    return report(context, safe(name) +
                               " administers the server from now on, and writes variables; "
                               "the code is void");
}

} // namespace

void add_setup(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    auto& arguments = group.arguments();
    auto* command = group.add(
        "setup", "Makes the first administrator: log in as --user setup, by the one-time code.", 1,
        "NAME", set_up);
    command->add_option("--new-password-file", arguments.new_password_file,
                        "its first line is the password; asked for on a terminal otherwise");
    command->add_option("--description", arguments.description, "a description of the user");
}

} // namespace busbar::tool::admin
