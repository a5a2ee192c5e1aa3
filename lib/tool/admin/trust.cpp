#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <busbar/crypto/revocation_list.hpp>
#include <busbar/types/enumerations.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool::admin {

namespace trust_lists {
namespace {

constexpr auto trusted_certificates =
    static_cast<std::uint32_t>(TrustListMasks::TrustedCertificates);
constexpr auto issuer_certificates = static_cast<std::uint32_t>(TrustListMasks::IssuerCertificates);
constexpr auto trusted_crls = static_cast<std::uint32_t>(TrustListMasks::TrustedCrls);
constexpr auto issuer_crls = static_cast<std::uint32_t>(TrustListMasks::IssuerCrls);

std::string name_of(const crypto::Certificate& certificate)
{
    return certificate.thumbprint_text() + " (" + safe(certificate.subject()) + ")";
}

std::string name_of(const crypto::RevocationList& list)
{
    return "the revocation list " + list.thumbprint_text() + " of " + safe(list.issuer());
}

void take_revocations(const char* name, const Array<ByteString>& ders,
                      std::vector<RevocationRow>& rows)
{
    for (const ByteString& der : ders) {
        if (auto parsed = crypto::RevocationList::parse(der.span())) {
            rows.push_back({name, *std::move(parsed)});
        }
    }
}

TrustRows rows_of(Connection& connection, const TrustListDataType& lists)
{
    TrustRows rows;
    const auto take = [&](const char* name, std::vector<crypto::Certificate> certificates) {
        for (crypto::Certificate& certificate : certificates) {
            rows.certificates.push_back({name, std::move(certificate)});
        }
    };
    take("trusted", certificates_of(lists.trusted_certificates));
    take("issuers", certificates_of(lists.issuer_certificates));
    take("rejected", rejected(connection));
    take_revocations("trusted", lists.trusted_crls, rows.revocations);
    take_revocations("issuers", lists.issuer_crls, rows.revocations);
    return rows;
}

TrustListDataType lists_of(Connection& connection, const AdminArguments& arguments)
{
    return read_trust_list(connection, trust_list(connection, arguments.is_of_users));
}

TrustRows rows_of(Connection& connection, const AdminArguments& arguments)
{
    return rows_of(connection, lists_of(connection, arguments));
}

Exit list(Context& context, Connection& connection, const AdminArguments& arguments)
{
    print_trust(context, rows_of(connection, arguments), arguments.order);
    return Exit::Good;
}

Exit show(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const TrustRows rows = rows_of(connection, arguments);
    if (const RevocationRow* const row = find(rows.revocations, arguments.words.front())) {
        print_details(context, *row);
    } else {
        print_details(context, find(rows.certificates, arguments.words.front()));
    }
    return Exit::Good;
}

/// Certificates and revocation lists to add, each with its file.
struct Additions {
    std::vector<std::pair<std::string, crypto::Certificate>> certificates;
    std::vector<std::pair<std::string, crypto::RevocationList>> revocations;
};

/// Reads all files before anything is changed.
Additions read_additions(const std::vector<std::string>& files)
{
    Additions additions;
    for (const std::string& file : files) {
        const std::string contents = read_file(file);
        const auto bytes = std::as_bytes(std::span{contents});
        if (auto revocations = crypto::RevocationList::parse_file(bytes)) {
            additions.revocations.emplace_back(file, *std::move(revocations));
        } else if (auto certificate = crypto::Certificate::parse_file(bytes)) {
            additions.certificates.emplace_back(file, *std::move(certificate));
        } else {
            throw Failure{Exit::Usage, file + ": neither a certificate nor a revocation list",
                          "expected one, as DER or PEM"};
        }
    }
    if (files.empty()) {
        throw Failure{Exit::Usage, "no file is given", "expected FILE..."};
    }
    return additions;
}

/// Refuses certificates that the server already has, and those that it rejected, which must be
/// moved (W588, 3-2-5).
void check_certificates(const Additions& additions, const TrustRows& rows, const char* to)
{
    for (const auto& [file, certificate] : additions.certificates) {
        for (const CertificateRow& row : rows.certificates) {
            if (!(row.certificate == certificate)) {
                continue;
            }
            if (row.list == to) {
                throw Failure{status::Bad_EntryExists,
                              file + ": the server has it among the " + row.list +
                                  " ones already: " + name_of(certificate),
                              "nothing was added"};
            }
            if (row.list == "rejected") {
                throw Failure{status::Bad_EntryExists,
                              file + ": the server has rejected it: " + name_of(certificate),
                              "`busbar admin trust move " + certificate.thumbprint_text() +
                                  "` trusts it; nothing was added"};
            }
        }
    }
}

/// Adds a revocation list beside its issuer, replacing an older one of that issuer: among the
/// trusted ones if the issuer is in both lists, unless --issuer is given.
void add_revocations(const std::string& file, const crypto::RevocationList& added, bool are_issuers,
                     TrustListDataType& lists)
{
    const auto has_issuer = [&](const Array<ByteString>& ders) {
        const auto certificates = certificates_of(ders);
        return std::any_of(certificates.begin(), certificates.end(),
                           [&](const auto& each) { return added.names_issuer(each); });
    };
    const bool is_issuer = has_issuer(lists.issuer_certificates);
    const bool is_trusted = has_issuer(lists.trusted_certificates) && !(are_issuers && is_issuer);
    if (!is_trusted && !is_issuer) {
        throw Failure{Exit::Failed,
                      file + ": the server does not have the issuer of the revocation list, " +
                          safe(added.issuer()),
                      "add its issuer first, or with it: busbar admin trust add --issuer FILE..."};
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
    lists.specified_lists |= is_trusted ? trusted_crls : issuer_crls;
}

/// Removes revoked certificates from the trusted ones, because a server refuses a list with both.
/// Their owners could no longer connect anyway.
std::vector<crypto::Certificate> take_out_revoked(const crypto::RevocationList& added,
                                                  TrustListDataType& lists)
{
    std::vector<crypto::Certificate> revoked;
    Array<ByteString> kept;
    kept.clear();
    for (const ByteString& der : lists.trusted_certificates) {
        auto certificate = crypto::Certificate::parse(der.span());
        if (certificate && added.revoked_at(*certificate)) {
            revoked.push_back(*std::move(certificate));
        } else {
            kept.push_back(der);
        }
    }
    if (!revoked.empty()) {
        lists.trusted_certificates = std::move(kept);
        lists.specified_lists |= trusted_certificates;
    }
    return revoked;
}

/// Adds certificates. An issuer is not a client by itself: clients with its certificates are
/// trusted if they, or the issuer, are in the trusted list.
void add_certificates(const Additions& additions, bool are_issuers, TrustListDataType& lists)
{
    for (const auto& each : additions.certificates) {
        (are_issuers ? lists.issuer_certificates : lists.trusted_certificates)
            .push_back(ByteString{each.second.der()});
        lists.specified_lists |= are_issuers ? issuer_certificates : trusted_certificates;
    }
}

void trust(Connection& connection, const TrustListNodes& nodes,
           const crypto::Certificate& certificate)
{
    call(connection, nodes.object, nodes.add,
         {Variant{ByteString{certificate.der()}}, Variant{true}}, "trusting the certificate");
}

/// Adds everything or nothing. Returns the certificates that are no longer trusted because they are
/// revoked.
std::vector<crypto::Certificate> add_together(Connection& connection, const TrustListNodes& nodes,
                                              const Additions& additions, bool are_issuers,
                                              TrustListDataType lists)
{
    lists.specified_lists = 0;
    add_certificates(additions, are_issuers, lists);
    std::vector<crypto::Certificate> revoked;
    for (const auto& [file, revocations] : additions.revocations) {
        add_revocations(file, revocations, are_issuers, lists);
        std::ranges::move(take_out_revoked(revocations, lists), std::back_inserter(revoked));
    }
    write_trust_list(connection, nodes, lists, "adding to the trust list");
    return revoked;
}

Exit add(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const Additions additions = read_additions(arguments.words);
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    TrustListDataType lists = read_trust_list(connection, nodes);
    const bool are_issuers = arguments.is_issuer;
    std::vector<crypto::Certificate> revoked;
    check_certificates(additions, rows_of(connection, lists), are_issuers ? "issuers" : "trusted");
    if (!are_issuers && additions.certificates.size() == 1 && additions.revocations.empty()) {
        trust(connection, nodes, additions.certificates.front().second);
    } else {
        revoked = add_together(connection, nodes, additions, are_issuers, std::move(lists));
    }
    for (const auto& each : additions.certificates) {
        report(context, (are_issuers ? "added the issuer " : "trusted ") + name_of(each.second));
    }
    for (const auto& each : additions.revocations) {
        report(context, "added " + name_of(each.second) + ", " +
                            std::to_string(each.second.size()) + " revoked");
    }
    for (const crypto::Certificate& each : revoked) {
        report(context, "removed " + name_of(each) + " from trusted: it is revoked");
    }
    return Exit::Good;
}

/// Calls a Method of busbar-controller, because the standard has none for this.
void remove_rejected(Connection& connection, const crypto::Certificate& certificate)
{
    const NodeId configuration = standard(id::ServerConfiguration);
    const NodeId method = find_method(connection, configuration, "RemoveRejectedCertificate");
    if (method.is_null()) {
        throw Failure{status::Bad_NotSupported, "removing the rejected certificate",
                      "the server has no Method for that, or this user may not see it: log in as "
                      "one with the role SecurityAdmin"};
    }
    call(connection, configuration, method, {Variant{String{certificate.thumbprint_text()}}},
         "removing the rejected certificate");
}

Exit move(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    std::vector<CertificateRow> rows;
    for (crypto::Certificate& certificate : rejected(connection)) {
        rows.push_back({"rejected", std::move(certificate)});
    }
    const crypto::Certificate& certificate = find(rows, arguments.words.front()).certificate;
    if (arguments.is_issuer) {
        static_cast<void>(add_together(connection, nodes, {{{"", certificate}}, {}}, true,
                                       read_trust_list(connection, nodes)));
        remove_rejected(connection, certificate);
        return report(context, "added the issuer " + name_of(certificate));
    }
    trust(connection, nodes, certificate);
    return report(context, "trusted " + name_of(certificate));
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
    return report(context, "removed " + name_of(row.revocations));
}

Exit remove(Context& context, Connection& connection, const AdminArguments& arguments)
{
    TrustListDataType lists = lists_of(connection, arguments);
    const TrustRows rows = rows_of(connection, lists);
    if (const RevocationRow* const row = find(rows.revocations, arguments.words.front())) {
        return remove_revocations(context, connection, arguments, std::move(lists), *row);
    }
    const CertificateRow& row = find(rows.certificates, arguments.words.front());
    const std::string what = name_of(row.certificate);
    if (row.list == "rejected") {
        make_sure(context, arguments, "Remove " + what + " from rejected?");
        remove_rejected(connection, row.certificate);
        return report(context, "removed " + what);
    }
    make_sure(context, arguments,
              "Its owner can no longer connect. Remove " + what + " from " + row.list + "?");
    const TrustListNodes nodes = trust_list(connection, arguments.is_of_users);
    call(connection, nodes.object, nodes.remove,
         {Variant{String{row.certificate.thumbprint_text()}}, Variant{row.list == "trusted"}},
         "removing the certificate");
    return report(context, "removed " + what);
}

/// True if the word is the beginning of a thumbprint in the lists.
bool names_one(const TrustRows& rows, const std::string& word)
{
    const std::string wanted = crypto::spelled_thumbprint(word);
    return !wanted.empty() &&
           (std::ranges::any_of(rows.certificates,
                                [&](const CertificateRow& row) {
                                    return row.certificate.thumbprint_text().starts_with(wanted);
                                }) ||
            std::ranges::any_of(rows.revocations, [&](const RevocationRow& row) {
                return row.revocations.thumbprint_text().starts_with(wanted);
            }));
}

Exit export_one(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const TrustRows rows = rows_of(connection, arguments);
    // Accept both orders, because `busbar cert export` has the other one.
    const bool is_file_first = names_one(rows, arguments.words[1]);
    const std::string& file = arguments.words[is_file_first ? 0 : 1];
    const std::string& thumbprint = arguments.words[is_file_first ? 1 : 0];
    const auto write = [&](std::span<const std::byte> der) {
        write_file(file, {reinterpret_cast<const char*>(der.data()), der.size()});
    };
    if (const RevocationRow* const row = find(rows.revocations, thumbprint)) {
        write(row->revocations.der());
        return report(context, "exported " + name_of(row->revocations));
    }
    const CertificateRow& row = find(rows.certificates, thumbprint);
    write(row.certificate.der());
    return report(context, "exported " + row.certificate.thumbprint_text());
}

} // namespace
} // namespace trust_lists

void add_trust(CLI::App& admin, Run& run)
{
    using namespace trust_lists;
    Group group{admin, run, "trust", "The certificates that the server trusts."};
    auto& arguments = group.arguments();
    auto* listed = group.add(
        "list", "Lists certificates, trusted, issuers and rejected, and revocation lists (crl).", 0,
        "URL", list);
    listed->add_option("--sort", arguments.order.column, "the column that each list is sorted by")
        ->check(CLI::IsMember(
            std::vector<std::string>(std::begin(trust_columns), std::end(trust_columns))))
        ->capture_default_str();
    listed->add_flag("--descending", arguments.order.is_descending, "the last one first");
    group.add("show", "Shows all that a certificate or a revocation list says.", 1, "THUMBPRINT",
              show);
    auto* added = group.add_any("add",
                                "Trusts the certificates of files, and takes revocation lists: all "
                                "or, if one is refused, none of them.",
                                "FILE", add);
    added->add_flag("--issuer", arguments.is_issuer,
                    "the files are certificates of CAs that issue others, and are not trusted "
                    "themselves");
    auto* moved =
        group.add("move", "Trusts a certificate that the server rejected.", 1, "THUMBPRINT", move);
    moved->add_flag("--issuer", arguments.is_issuer,
                    "it belongs to a CA that issues others, and is not trusted itself");
    auto* removed =
        group.add("remove", "Takes a certificate, also a rejected one, or a revocation list out.",
                  1, "THUMBPRINT", remove);
    removed->add_flag("--yes", arguments.is_sure, "do not ask");
    group.add("export", "Writes a certificate or a revocation list to a DER file.", 2,
              "FILE THUMBPRINT", export_one);
    for (auto* command : admin.get_subcommand("trust")->get_subcommands({})) {
        command->add_flag("--users", arguments.is_of_users,
                          "the list of users' certificates, not that of applications");
    }
}

} // namespace busbar::tool::admin
