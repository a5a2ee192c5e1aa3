#include "trust_list_file.hpp"

#include <string>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::administration::detail {

namespace {

bool has(std::uint32_t masks, TrustListMasks list)
{
    return (masks & static_cast<std::uint32_t>(list)) != 0;
}

template <typename T>
Array<ByteString> ders_of(bool is_wanted, const std::vector<T>& objects)
{
    Array<ByteString> result;
    result.clear();
    if (is_wanted) {
        for (const T& object : objects) {
            result.push_back(ByteString{object.der()});
        }
    }
    return result;
}

Unexpected<Refusal> refuse_list(StatusCode status, std::string found, std::string remedy = {})
{
    return refuse({status, "trust list", std::move(found), "Part 12, 7.8.2", std::move(remedy)});
}

/// Decodes the elements of one list.
template <typename T>
Checked<std::vector<T>> parse_all(const Array<ByteString>& ders, std::string_view what)
{
    std::vector<T> result;
    for (std::size_t i = 0; i < ders.size(); ++i) {
        auto object = T::parse(ders[i].span());
        if (!object) {
            return refuse_list(status::Bad_CertificateInvalid, std::string{what} + " number " +
                                                                   std::to_string(i + 1) +
                                                                   " cannot be read, expected DER");
        }
        result.push_back(*std::move(object));
    }
    return result;
}

} // namespace

std::vector<std::byte> bytes_of(const crypto::TrustList& list, std::uint32_t masks)
{
    TrustListDataType data;
    data.specified_lists = masks & all_lists;
    data.trusted_certificates =
        ders_of(has(masks, TrustListMasks::TrustedCertificates), list.trusted);
    data.trusted_crls = ders_of(has(masks, TrustListMasks::TrustedCrls), list.trusted_crls);
    data.issuer_certificates =
        ders_of(has(masks, TrustListMasks::IssuerCertificates), list.issuers);
    data.issuer_crls = ders_of(has(masks, TrustListMasks::IssuerCrls), list.issuer_crls);
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, data);
    return sink.take(writer.written());
}

Checked<crypto::TrustList> merge(std::span<const std::byte> bytes, crypto::TrustList list,
                                 crypto::TrustListParts& parts)
{
    TrustListDataType data;
    binary::Reader reader{bytes};
    decode(reader, data);
    if (!reader.ok() || reader.remaining() != 0 || (data.specified_lists & ~all_lists) != 0) {
        return refuse_list(status::Bad_InvalidArgument,
                           "the written bytes are not a TrustListDataType");
    }
    const std::uint32_t masks = data.specified_lists;
    parts = {
        has(masks, TrustListMasks::TrustedCertificates), has(masks, TrustListMasks::TrustedCrls),
        has(masks, TrustListMasks::IssuerCertificates), has(masks, TrustListMasks::IssuerCrls)};
    const auto take = [](bool is_meant, auto parsed, auto& into) -> Checked<void> {
        if (!is_meant) {
            return {};
        }
        if (!parsed) {
            return refuse(std::move(parsed).error());
        }
        into = *std::move(parsed);
        return {};
    };
    using crypto::Certificate;
    using crypto::RevocationList;
    auto done = take(parts.trusted,
                     parse_all<Certificate>(data.trusted_certificates, "trusted certificate"),
                     list.trusted);
    done = done ? take(parts.trusted_crls,
                       parse_all<RevocationList>(data.trusted_crls, "revocation list"),
                       list.trusted_crls)
                : done;
    done = done ? take(parts.issuers,
                       parse_all<Certificate>(data.issuer_certificates, "issuer certificate"),
                       list.issuers)
                : done;
    done = done ? take(parts.issuer_crls,
                       parse_all<RevocationList>(data.issuer_crls, "issuer's revocation list"),
                       list.issuer_crls)
                : done;
    if (!done) {
        return refuse(std::move(done).error());
    }
    return list;
}

} // namespace busbar::administration::detail
