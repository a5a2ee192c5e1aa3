#include <string>

#include <busbar/crypto/revocation_list.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool::admin {

namespace trust_lists {
namespace {

std::vector<CertificateRow> rows_of(Connection& connection, bool of_users, bool with_rejected)
{
    std::vector<CertificateRow> rows;
    const TrustListDataType lists = read_trust_list(connection, trust_list(connection, of_users));
    const auto take = [&](const char* name, std::vector<crypto::Certificate> certificates) {
        for (crypto::Certificate& certificate : certificates) {
            rows.push_back({name, std::move(certificate)});
        }
    };
    take("trusted", certificates_of(lists.trusted_certificates));
    take("issuers", certificates_of(lists.issuer_certificates));
    if (with_rejected) {
        take("rejected", rejected(connection));
    }
    return rows;
}

Exit list(Context& context, Connection& connection, const AdminArguments& arguments)
{
    print_certificates(context, rows_of(connection, arguments.is_of_users, true));
    return Exit::Good;
}

Exit add_certificate(Context& context, Connection& connection, const AdminArguments& arguments,
                     const crypto::Certificate& certificate)
{
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    call(connection, nodes.object, nodes.add,
         {Variant{ByteString{certificate.der()}}, Variant{true}}, "trusting the certificate");
    return report(context, "trusted " + certificate.thumbprint_text() + " (" +
                               safe(certificate.subject()) + ")");
}

Exit add(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& file = arguments.words.front();
    const std::string contents = read_file(file);
    const auto certificate = crypto::Certificate::parse_file(std::as_bytes(std::span{contents}));
    if (!certificate) {
        throw Failure{Exit::Usage, file + ": no certificate", "expected one, as DER or PEM"};
    }
    return add_certificate(context, connection, arguments, *certificate);
}

Exit move(Context& context, Connection& connection, const AdminArguments& arguments)
{
    std::vector<CertificateRow> rows;
    for (crypto::Certificate& certificate : rejected(connection)) {
        rows.push_back({"rejected", std::move(certificate)});
    }
    const auto& row = find(rows, arguments.words.front());
    return add_certificate(context, connection, arguments, row.certificate);
}

Exit remove(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const auto rows = rows_of(connection, arguments.is_of_users, false);
    const CertificateRow& row = find(rows, arguments.words.front());
    const std::string what =
        row.certificate.thumbprint_text() + " (" + safe(row.certificate.subject()) + ")";
    make_sure(context, arguments,
              "Its owner cannot connect any more. Remove " + what + " from " + row.list + "?");
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    call(connection, nodes.object, nodes.remove,
         {Variant{String{row.certificate.thumbprint_text()}}, Variant{row.list == "trusted"}},
         "removing the certificate");
    return report(context, "removed " + what);
}

Exit export_certificate(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const auto rows = rows_of(connection, arguments.is_of_users, true);
    const CertificateRow& row = find(rows, arguments.words[0]);
    const auto der = row.certificate.der();
    write_file(arguments.words[1], {reinterpret_cast<const char*>(der.data()), der.size()});
    return report(context, "exported " + row.certificate.thumbprint_text());
}

} // namespace
} // namespace trust_lists

void add_trust(CLI::App& admin, Run& run)
{
    using namespace trust_lists;
    Group group{admin, run, "trust", "Whom the server trusts."};
    auto& arguments = group.arguments();
    group.add("list", "Lists certificates: trusted, issuers, rejected.", 0, "URL", list);
    group.add("add", "Trusts the certificate of a file.", 1, "FILE", add);
    group.add("move", "Trusts a certificate that the server rejected.", 1, "THUMBPRINT", move);
    auto* removed = group.add("remove", "Trusts a certificate no more.", 1, "THUMBPRINT", remove);
    removed->add_flag("--yes", arguments.is_sure, "do not ask");
    group.add("export", "Writes a certificate to a DER file.", 2, "THUMBPRINT FILE",
              export_certificate);
    for (auto* command : admin.get_subcommand("trust")->get_subcommands({})) {
        command->add_flag("--users", arguments.is_of_users,
                          "the list of users' certificates, not that of applications");
    }
}

} // namespace busbar::tool::admin
