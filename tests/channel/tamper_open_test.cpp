#include <catch2/catch.hpp>

#include "support/effort.hpp"
#include "tampering.hpp"

namespace tamper_open_test {

using namespace busbar;
using namespace busbar::test;
using namespace busbar::channel::detail;
using channel::ClientChannel;
using channel::SecuritySetting;
using channel::ServerChannel;
using Kind = channel::ChannelEvent::Kind;

namespace {

/// Where the parts of an OPN begin; the last is its end.
std::vector<std::size_t> parts_of(const Bytes& open)
{
    const auto header = parse_asymmetric_header(open);
    REQUIRE(header);
    const std::size_t uri_end = 16 + header->policy->uri.size();
    const std::size_t certificate_end = uri_end + 4 + header->sender_certificate.size();
    return {0, 4, 8, 12, 16, uri_end, uri_end + 4, certificate_end, header->size, open.size()};
}

/// The first and the last byte of each part and some between.
std::vector<std::size_t> places_in(const std::vector<std::size_t>& parts, std::size_t stride)
{
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
        for (std::size_t at = parts[i]; at + 1 < parts[i + 1]; at += stride) {
            places.push_back(at);
        }
        places.push_back(parts[i + 1] - 1);
    }
    return places;
}

/// What a server tells of an OPN that was changed in that place.
StatusCode told_of_open(std::size_t at, const std::vector<std::size_t>& parts)
{
    if (at < 4) {
        return status::Bad_TcpMessageTypeInvalid;
    }
    if (at == 6 || at == 7) {
        return status::Bad_TcpMessageTooLarge;
    }
    if (at >= 8 && at < 12) {
        return status::Bad_TcpSecureChannelUnknown;
    }
    return at >= 16 && at < parts[5] ? status::Bad_SecurityPolicyRejected
                                     : status::Bad_SecurityChecksFailed;
}

/// `open` with another cipher text.
Bytes with_cipher(const Bytes& open, const Bytes& cipher)
{
    const auto headers = static_cast<std::ptrdiff_t>(parts_of(open)[8]);
    Bytes message{open.begin(), open.begin() + headers};
    message.insert(message.end(), cipher.begin(), cipher.end());
    write_frame_header(message,
                       {MessageType::OPN, 'F', static_cast<std::uint32_t>(message.size())});
    return message;
}

/// `open` with its text decrypted, changed and encrypted again.
template <typename Engine, typename Change>
Bytes changed_text(const Bytes& open, Change change)
{
    const auto& receiver = Script<Engine>::peer();
    const auto header = parse_asymmetric_header(open);
    REQUIRE(header);
    auto text = crypto::asymmetric_decrypt(*header->policy, receiver.key,
                                           std::span{open}.subspan(header->size));
    REQUIRE(text);
    change(*text);
    const auto cipher =
        crypto::asymmetric_encrypt(*header->policy, receiver.certificates.front(), *text);
    REQUIRE(cipher);
    return with_cipher(open, *cipher);
}

/// As many blocks as in the cipher text of `open`, all of them with another padding.
template <typename Engine>
Bytes other_padding(const Bytes& open)
{
    crypto::SecurityPolicy policy = *parse_asymmetric_header(open)->policy;
    policy.encryption = policy.encryption == crypto::AsymmetricEncryption::OaepSha256
                            ? crypto::AsymmetricEncryption::OaepSha1
                            : crypto::AsymmetricEncryption::OaepSha256;
    Bytes cipher;
    for (std::size_t left = open.size() - parts_of(open)[8]; left >= 256; left -= 256) {
        const auto block = crypto::asymmetric_encrypt(
            policy, Script<Engine>::peer().certificates.front(), Bytes(100));
        cipher.insert(cipher.end(), block->begin(), block->end());
    }
    return with_cipher(open, cipher);
}

} // namespace

TEMPLATE_TEST_CASE("an OPN is refused wherever it was changed on its way", "[channel][tamper]",
                   ServerChannel, WorkedServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        for (const Stage stage : {Stage::Greeted, Stage::Renewing}) {
            INFO(setting.policy->name << (stage == Stage::Greeted ? " Issue" : " Renew"));
            Recording<TestType> recording{setting};
            const Bytes open = recording.awaited_open(stage);
            const auto parts = parts_of(open);
            for (const std::size_t at : places_in(parts, is_full_effort() ? 151 : 453)) {
                INFO("byte " << at << " of " << open.size());
                Subject<TestType> subject{setting};
                recording.bring(subject, stage);
                subject.feed(flipped(open, at));
                subject.feed(Bytes(8'192));
                check_refused(subject, subject.reason(), told_of_open(at, parts));
                CHECK(subject.reason().is_bad());
            }
        }
    }
}

TEMPLATE_TEST_CASE("an OPN is refused if its text is not what was signed", "[channel][tamper]",
                   ServerChannel, WorkedServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        for (const Stage stage : {Stage::Greeted, Stage::Renewing}) {
            INFO(setting.policy->name << (stage == Stage::Greeted ? " Issue" : " Renew"));
            Recording<TestType> recording{setting};
            const Bytes open = recording.awaited_open(stage);
            std::vector<std::size_t> parts;
            const auto find_parts = [&](const Bytes& text) {
                const std::size_t signature = text.size() - 256;
                const auto padding = std::to_integer<std::size_t>(text[signature - 1]) + 1;
                parts = {0, 4, 8, signature - padding, signature, text.size()};
            };
            Subject<TestType> untouched{setting};
            recording.bring(untouched, stage);
            untouched.feed(changed_text<TestType>(open, find_parts));
            CHECK(untouched.engine.is_open());
            CHECK(untouched.events.size() == 1); // Opened or Renewed
            for (const std::size_t at : places_in(parts, is_full_effort() ? 97 : 291)) {
                INFO("byte " << at << " of the text");
                Subject<TestType> subject{setting};
                recording.bring(subject, stage);
                subject.feed(
                    changed_text<TestType>(open, [&](Bytes& text) { text[at] ^= std::byte{1}; }));
                check_refused(subject, status::Bad_SecurityChecksFailed);
            }
        }
    }
}

TEMPLATE_TEST_CASE("whatever RSA makes of an OPN, it is refused alike", "[channel][tamper]",
                   ServerChannel, WorkedServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        INFO(setting.policy->name);
        Recording<TestType> recording{setting};
        const Bytes open = recording.opening[1];
        const auto refused = [&](const Bytes& message, StatusCode status) {
            Subject<TestType> subject{setting};
            recording.bring(subject, Stage::Greeted);
            subject.feed(message);
            check_refused(subject, status);
        };
        refused(other_padding<TestType>(open), status::Bad_SecurityChecksFailed);
        refused(changed_text<TestType>(open, [](Bytes& text) { text.resize(text.size() - 20); }),
                status::Bad_SecurityChecksFailed);
        for (const std::size_t size : {0U, 1U, 255U, 256U, 257U, 8 * 256U, 9 * 256U}) {
            INFO(size << " bytes of chance");
            refused(with_cipher(open, Bytes(size, std::byte{0x5A})),
                    status::Bad_SecurityChecksFailed);
        }
        for (const std::size_t excess : {std::size_t{1}, ~std::size_t{0}}) {
            recording.script.nonce_excess = excess;
            refused(recording.script.open(false, 1), status::Bad_NonceInvalid);
        }
    }
}

TEMPLATE_TEST_CASE("an OPN that was sent before is refused", "[channel][tamper]", ServerChannel,
                   WorkedServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        INFO(setting.policy->name);
        Recording<TestType> recording{setting};
        const Bytes renewal = recording.awaited_open(Stage::Renewing);
        Subject<TestType> again{setting};
        recording.bring(again, Stage::Renewing);
        again.feed(recording.opening[1]);
        CHECK(again.count(Kind::Renewed) == 0);
        CHECK(again.engine.is_closed());
        Subject<TestType> twice{setting};
        recording.bring(twice, Stage::Renewing);
        twice.feed(renewal);
        REQUIRE(twice.count(Kind::Renewed) == 1);
        twice.feed(renewal);
        CHECK(twice.count(Kind::Renewed) == 1);
        CHECK(twice.reason() == status::Bad_SequenceNumberInvalid);
    }
}

} // namespace tamper_open_test
