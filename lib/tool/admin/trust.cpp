#include <algorithm>
#include <string>

#include <busbar/crypto/revocation_list.hpp>
#include <busbar/types/enumerations.hpp>

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

constexpr auto issuer_certificates = static_cast<std::uint32_t>(TrustListMasks::IssuerCertificates);
constexpr auto trusted_crls = static_cast<std::uint32_t>(TrustListMasks::TrustedCrls);
constexpr auto issuer_crls = static_cast<std::uint32_t>(TrustListMasks::IssuerCrls);

std::vector<RevocationRow> revocations_of(const TrustListDataType& lists)
{
    std::vector<RevocationRow> rows;
    const auto take = [&](const char* name, const Array<ByteString>& ders) {
        for (const ByteString& der : ders) {
            if (auto parsed = crypto::RevocationList::parse(der.span())) {
                rows.push_back({name, *std::move(parsed)});
            }
        }
    };
    take("trusted", lists.trusted_crls);
    take("issuers", lists.issuer_crls);
    return rows;
}

Exit list(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const TrustListDataType lists =
        read_trust_list(connection, trust_list(connection, arguments.is_of_users));
    print_trust(context, rows_of(connection, arguments.is_of_users, true), revocations_of(lists));
    return Exit::Good;
}

/// An issuer is no client by itself: those whose certificates it issued are, if they are trusted or
/// if it is trusted, too.
Exit add_issuer(Context& context, Connection& connection, const AdminArguments& arguments,
                const crypto::Certificate& certificate)
{
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    TrustListDataType lists = read_trust_list(connection, nodes);
    lists.specified_lists = issuer_certificates;
    lists.issuer_certificates.push_back(ByteString{certificate.der()});
    write_trust_list(connection, nodes, lists, "adding the issuer");
    return report(context, "added the issuer " + certificate.thumbprint_text() + " (" +
                               safe(certificate.subject()) + ")");
}

/// It lies where its issuer does, in the place of an older one of that issuer.
Exit add_revocations(Context& context, Connection& connection, const AdminArguments& arguments,
                     const crypto::RevocationList& added)
{
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    TrustListDataType lists = read_trust_list(connection, nodes);
    const auto has_issuer = [&](const Array<ByteString>& ders) {
        const auto certificates = certificates_of(ders);
        return std::any_of(certificates.begin(), certificates.end(),
                           [&](const auto& each) { return added.names_issuer(each); });
    };
    const bool is_trusted = has_issuer(lists.trusted_certificates);
    if (!is_trusted && !has_issuer(lists.issuer_certificates)) {
        throw Failure{Exit::Failed, "the revocation list of " + safe(added.issuer()),
                      "add its issuer first: busbar admin trust add FILE --issuer"};
    }
    Array<ByteString>& ders = is_trusted ? lists.trusted_crls : lists.issuer_crls;
    Array<ByteString> kept;
    kept.clear();
    for (const ByteString& der : ders) {
        const auto old = crypto::RevocationList::parse(der.span());
        if (!old || old->issuer() != added.issuer()) {
            kept.push_back(der);
        }
    }
    kept.push_back(ByteString{added.der()});
    ders = std::move(kept);
    lists.specified_lists = is_trusted ? trusted_crls : issuer_crls;
    write_trust_list(connection, nodes, lists, "adding the revocation list");
    return report(context, "added the revocation list " + added.thumbprint_text() + " of " +
                               safe(added.issuer()) + ", " + std::to_string(added.size()) +
                               " revoked");
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
    const auto bytes = std::as_bytes(std::span{contents});
    if (const auto revocations = crypto::RevocationList::parse_file(bytes)) {
        return add_revocations(context, connection, arguments, *revocations);
    }
    const auto certificate = crypto::Certificate::parse_file(bytes);
    if (!certificate) {
        throw Failure{Exit::Usage, file + ": no certificate and no revocation list",
                      "expected one, as DER or PEM"};
    }
    return arguments.is_issuer ? add_issuer(context, connection, arguments, *certificate)
                               : add_certificate(context, connection, arguments, *certificate);
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

/// The revocation list whose thumbprint begins so; null if there is none.
const RevocationRow* find_revocations(const std::vector<RevocationRow>& rows,
                                      const std::string& thumbprint)
{
    const std::string wanted = crypto::spelled_thumbprint(thumbprint);
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const RevocationRow& row) {
        return !wanted.empty() && row.revocations.thumbprint_text().starts_with(wanted);
    });
    return found != rows.end() ? &*found : nullptr;
}

Exit remove_revocations(Context& context, Connection& connection, const AdminArguments& arguments,
                        TrustListDataType lists, const RevocationRow& row)
{
    make_sure(context, arguments,
              "Certificates of " + safe(row.revocations.issuer()) +
                  " are not accepted without its revocation list. Remove it?");
    const bool is_trusted = row.list == "trusted";
    Array<ByteString>& ders = is_trusted ? lists.trusted_crls : lists.issuer_crls;
    Array<ByteString> kept;
    kept.clear();
    for (const ByteString& der : ders) {
        if (!std::ranges::equal(der.span(), row.revocations.der())) {
            kept.push_back(der);
        }
    }
    ders = std::move(kept);
    lists.specified_lists = is_trusted ? trusted_crls : issuer_crls;
    write_trust_list(connection, trust_list(connection, arguments.is_of_users), lists,
                     "removing the revocation list");
    return report(context, "removed the revocation list " + row.revocations.thumbprint_text());
}

Exit remove(Context& context, Connection& connection, const AdminArguments& arguments)
{
    TrustListDataType lists =
        read_trust_list(connection, trust_list(connection, arguments.is_of_users));
    const auto revocations = revocations_of(lists);
    if (const auto* const found = find_revocations(revocations, arguments.words.front())) {
        return remove_revocations(context, connection, arguments, std::move(lists), *found);
    }
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

bool names_one(const std::vector<CertificateRow>& rows, const std::string& word)
{
    const std::string wanted = crypto::spelled_thumbprint(word);
    return !wanted.empty() && std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
        return row.certificate.thumbprint_text().starts_with(wanted);
    });
}

Exit export_certificate(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const auto rows = rows_of(connection, arguments.is_of_users, true);
    // As `busbar cert export` has it, or the other way round.
    const bool is_file_first = names_one(rows, arguments.words[1]);
    const CertificateRow& row = find(rows, arguments.words[is_file_first ? 1 : 0]);
    const auto der = row.certificate.der();
    write_file(arguments.words[is_file_first ? 0 : 1],
               {reinterpret_cast<const char*>(der.data()), der.size()});
    return report(context, "exported " + row.certificate.thumbprint_text());
}

} // namespace
} // namespace trust_lists

void add_trust(CLI::App& admin, Run& run)
{
    using namespace trust_lists;
    Group group{admin, run, "trust", "Whom the server trusts."};
    auto& arguments = group.arguments();
    group.add("list",
              "Lists certificates, trusted, issuers and rejected, and revocation lists (crl).", 0,
              "URL", list);
    auto* added = group.add("add", "Trusts the certificate of a file, or takes a revocation list.",
                            1, "FILE", add);
    added->add_flag("--issuer", arguments.is_issuer,
                    "the file is the certificate of a CA that issues others, and is not trusted "
                    "itself");
    group.add("move", "Trusts a certificate that the server rejected.", 1, "THUMBPRINT", move);
    auto* removed = group.add("remove", "Takes a certificate or a revocation list out.", 1,
                              "THUMBPRINT", remove);
    removed->add_flag("--yes", arguments.is_sure, "do not ask");
    group.add("export", "Writes a certificate to a DER file.", 2, "FILE THUMBPRINT",
              export_certificate);
    for (auto* command : admin.get_subcommand("trust")->get_subcommands({})) {
        command->add_flag("--users", arguments.is_of_users,
                          "the list of users' certificates, not that of applications");
    }
}

} // namespace busbar::tool::admin
