#include <busbar/types/discovery.hpp>

#include "requests.hpp"
#include "wire.hpp"

namespace busbar::tool::rules {

namespace {
namespace transport {

constexpr std::size_t response_offset = 16; // SecureChannelId, TokenId, both of the sequence header

/// The answer to bytes on a fresh connection.
Answer first_bytes(Subject& subject, std::string_view type, std::uint32_t size)
{
    Wire wire{subject};
    wire.send(bytes_of([&](binary::Writer& writer) {
        writer.bytes(std::as_bytes(std::span{type}));
        encode(writer, size);
        writer.bytes(Bytes(32));
    }));
    return wire.refusal();
}

Answer second_hello(Subject& subject)
{
    Wire wire{subject};
    static_cast<void>(wire.hello({}));
    wire.send("HELF", bytes_of([](binary::Writer& writer) { writer.bytes(Bytes(24)); }));
    Answer answer = wire.refusal();
    if (answer.kind == Answer::Kind::Status) {
        return right();
    }
    return answer;
}

template <typename Judge>
Answer acknowledged(Subject& subject, const HelloForm& form, Judge judge)
{
    Wire wire{subject};
    const auto answer = wire.hello(form);
    if (!answer || answer->type != "ACKF") {
        return wrong(!answer                  ? "the connection was closed"
                     : answer->type == "ERRF" ? text_of(StatusCode{answer->number(0)})
                                              : "a chunk " + answer->type);
    }
    return judge(*answer);
}

Answer buffers(const RawChunk& acknowledge)
{
    const std::uint32_t receives = acknowledge.number(4);
    const std::uint32_t sends = acknowledge.number(8);
    return expect(receives >= 8'192 && receives <= 65'535 && sends >= 8'192 && sends <= 65'535,
                  std::to_string(receives) + " and " + std::to_string(sends));
}

/// Sends a chunk on an open channel, which has to refuse it.
Answer refused(Subject& subject, std::string_view type,
               const std::function<Bytes(RawChannel&)>& body)
{
    RawChannel channel{subject};
    channel.wire().send(type, body(channel));
    return channel.wire().refusal();
}

/// Returns the status of an OpenSecureChannel on an open channel.
Answer opened(Subject& subject, SecurityTokenRequestType type,
              const std::function<void(OpenSecureChannelRequest&)>& change = {},
              std::string_view policy = {}, std::uint32_t channel_id = 0)
{
    RawChannel channel{subject};
    channel.wire().send("OPNF", channel.open_request(type, change, policy, channel_id));
    const auto response = channel.take_token(channel.wire().receive());
    return came(response ? StatusCode{status::Good} : response.error());
}

/// The status in a response to GetEndpoints on a raw channel, or of the refusal.
Answer response_status(const std::optional<RawChunk>& chunk)
{
    if (!chunk) {
        return came(status::Bad_ConnectionClosed);
    }
    if (chunk->type == "ERRF") {
        return came(StatusCode{chunk->number(0)});
    }
    if (chunk->type == "MSGA") { // Part 6, 6.7.3
        return came(StatusCode{chunk->number(response_offset)});
    }
    if (!chunk->type.starts_with("MSG") || chunk->body.size() < response_offset) {
        return wrong("a chunk " + chunk->type);
    }
    const auto fault =
        client::decode_response<ServiceFault>(std::span{chunk->body}.subspan(response_offset),
                                              binary::Strings::Own, client::response_limits);
    return came(fault ? fault->response_header.service_result : StatusCode{status::Good});
}

Answer request_id(Subject& subject)
{
    RawChannel channel{subject};
    const auto chunk = channel.ask();
    const std::uint32_t found = chunk ? chunk->number(12) : 0;
    return expect(found == channel.request_id(), std::to_string(found));
}

Answer sequence_numbers(Subject& subject)
{
    RawChannel channel{subject};
    std::uint32_t last = 0;
    for (int i = 0; i < 2; ++i) {
        auto chunk = channel.ask();
        while (chunk && chunk->type.starts_with("MSG")) {
            const std::uint32_t number = chunk->number(8);
            if (last != 0 && number != last + 1) {
                return wrong(std::to_string(number) + " after " + std::to_string(last));
            }
            last = number;
            if (chunk->type != "MSGC") {
                break;
            }
            chunk = channel.wire().receive();
        }
    }
    return expect(last != 0, "no response");
}

Answer in_two_chunks(Subject& subject)
{
    RawChannel channel{subject};
    const Bytes request = channel.some_request();
    const std::span all{request};
    channel.wire().send("MSGC", channel.message(all.first(10)));
    channel.wire().send("MSGF", channel.message(all.subspan(10)));
    return response_status(channel.wire().receive());
}

Answer aborted(Subject& subject)
{
    RawChannel channel{subject};
    channel.wire().send("MSGC", channel.message(channel.some_request()));
    channel.wire().send("MSGA", channel.message(bytes_of([](binary::Writer& writer) {
        encode(writer, status::Bad_RequestTooLarge);
        encode(writer, String{"given up"});
    })));
    return response_status(channel.ask());
}

Answer chunk_sizes(Subject& subject)
{
    RawChannel channel{subject, {.buffer_size = 8'192}};
    for (auto chunk = channel.ask(); chunk; chunk = channel.wire().receive()) {
        if (chunk->size() > 8'192) {
            return wrong("a chunk of " + std::to_string(chunk->size()) + " bytes");
        }
        if (chunk->type != "MSGC") {
            return expect(chunk->type == "MSGF", "a chunk " + chunk->type);
        }
    }
    return wrong("the connection was closed");
}

Answer small_responses(Subject& subject)
{
    try {
        RawChannel channel{subject, {.max_message_size = 60}};
        return response_status(channel.ask());
    } catch (const Refused& refused) {
        return not_applicable(refused.what + " with so small a MaxMessageSize is refused");
    }
}

/// Renews the token of a channel; `judge` gets the old one.
template <typename Judge>
Answer renewed(Subject& subject, Judge judge)
{
    RawChannel channel{subject};
    const ChannelSecurityToken old = channel.token();
    channel.wire().send("OPNF", channel.open_request(SecurityTokenRequestType::Renew));
    const auto response = channel.take_token(channel.wire().receive());
    return response ? judge(channel, old) : came(response.error());
}

Answer with_token(RawChannel& channel, std::uint32_t token_id)
{
    channel.wire().send("MSGF", channel.message(channel.some_request(), 0, token_id));
    return response_status(channel.wire().receive());
}

/// Sends a message with the first token after its renewal; `is_used`: and one before.
Answer old_token(Subject& subject, bool is_used)
{
    RawChannel channel{subject};
    const ChannelSecurityToken old = channel.token();
    if (is_used && !channel.ask()) {
        return came(status::Bad_ConnectionClosed);
    }
    channel.wire().send("OPNF", channel.open_request(SecurityTokenRequestType::Renew));
    const auto response = channel.take_token(channel.wire().receive());
    return response ? with_token(channel, old.token_id) : came(response.error());
}

Answer closed(Subject& subject)
{
    RawChannel channel{subject};
    CloseSecureChannelRequest request;
    channel.wire().send("CLOF", channel.message(bytes_of([&](binary::Writer& writer) {
        encode(writer, NodeId{0, CloseSecureChannelRequest::binary_encoding_id});
        encode(writer, request);
    })));
    const auto chunk = channel.wire().receive();
    return expect(!chunk, "a chunk " + (chunk ? chunk->type : std::string{}));
}

Answer has_id(Subject& subject)
{
    const RawChannel channel{subject};
    return expect(channel.token().channel_id != 0, "0");
}

Answer lifetime(Subject& subject)
{
    RawChannel channel{subject};
    channel.wire().send("OPNF", channel.open_request(SecurityTokenRequestType::Renew,
                                                     [](OpenSecureChannelRequest& request) {
                                                         request.requested_lifetime = 0;
                                                     }));
    return with(channel.take_token(channel.wire().receive()),
                [](const OpenSecureChannelResponse& response) {
                    return expect(response.security_token.revised_lifetime > 0, "0");
                });
}

Answer too_large(Subject& subject)
{
    RawChannel channel{subject};
    const std::uint32_t size = channel.acknowledge().number(4) + 1;
    channel.wire().send(bytes_of([&](binary::Writer& writer) {
        writer.bytes(std::as_bytes(std::span{std::string_view{"MSGF"}}));
        encode(writer, size);
    }));
    return channel.wire().refusal();
}

constexpr StatusCode hung_up = status::Bad_ConnectionClosed;
constexpr Wanted bad_type{status::Bad_TcpMessageTypeInvalid, hung_up};
constexpr Wanted no_channel{status::Bad_TcpSecureChannelUnknown, status::Bad_SecureChannelIdInvalid,
                            status::Bad_SecureChannelTokenUnknown, status::Bad_SecurityChecksFailed,
                            hung_up};
constexpr Wanted bad_number{status::Bad_SequenceNumberInvalid, status::Bad_SecurityChecksFailed,
                            hung_up};
constexpr Wanted bad_mode{status::Bad_SecurityModeRejected, status::Bad_SecurityChecksFailed,
                          hung_up};
constexpr const char* hello = "Part 6, 7.1.2.3";
constexpr const char* errors = "Part 6, 7.1.5";
constexpr const char* opening = "Part 4, 5.6.2.3";
constexpr const char* tokens = "Part 6, 6.7.4";

const SpecRule rules[] = {
    {"hello", "UA TCP", "A Hello is acknowledged", "HEL", "an Acknowledge", "Part 6, 7.1.3",
     [](Subject& subject) {
         return acknowledged(subject, {}, [](const RawChunk&) { return right(); });
     }},
    {"hello-buffers", "UA TCP", "Buffers are as large as requested at most",
     "HEL with buffers of 65,535 bytes", "8,192 to 65,535 bytes", "Part 6, 7.1.2.4",
     [](Subject& subject) { return acknowledged(subject, {}, buffers); }},
    {"hello-version", "UA TCP", "A later version is accepted", "HEL with version 4294967295",
     "an Acknowledge", hello,
     [](Subject& subject) {
         return acknowledged(subject, {.version = 0xFFFF'FFFFU},
                             [](const RawChunk&) { return right(); });
     }},
    {"hello-url-long", "UA TCP", "A URL of more than 4,096 bytes is refused",
     "HEL with a URL of 5,000 bytes", one_of(status::Bad_TcpEndpointUrlInvalid, hung_up), hello,
     [](Subject& subject) {
         Wire wire{subject};
         const auto answer = wire.hello({.url = "opc.tcp://" + std::string(5'000, 'x')});
         return !answer                  ? came(hung_up)
                : answer->type == "ERRF" ? came(StatusCode{answer->number(0)})
                                         : wrong("a chunk " + answer->type);
     }},
    {"hello-twice", "UA TCP", "A second Hello is refused", "HEL after ACK",
     "an Error, or the end of the connection", "Part 6, 7.1.3", second_hello},
    {"hello-type-unknown", "UA TCP", "An unknown message type is refused", "XXXF", bad_type, errors,
     [](Subject& subject) { return first_bytes(subject, "XXXF", 40); }},
    {"hello-missing", "UA TCP", "An OPN before the Hello is refused", "OPNF", bad_type,
     "Part 6, 7.1.3", [](Subject& subject) { return first_bytes(subject, "OPNF", 40); }},
    {"hello-message-first", "UA TCP", "A MSG before the Hello is refused", "MSGF", bad_type,
     "Part 6, 7.1.3", [](Subject& subject) { return first_bytes(subject, "MSGF", 40); }},
    {"hello-acknowledge-first", "UA TCP", "A client's Acknowledge is refused", "ACKF", bad_type,
     "Part 6, 7.1.3", [](Subject& subject) { return first_bytes(subject, "ACKF", 40); }},
    {"hello-size-large", "UA TCP", "A Hello of 100 MB is refused", "HELF with size 100,000,000",
     one_of(status::Bad_TcpMessageTooLarge, hung_up), errors,
     [](Subject& subject) { return first_bytes(subject, "HELF", 100'000'000); }},
    {"channel-ids", "OpenSecureChannel", "A channel has an id", "Issue",
     "a SecureChannelId above 0", "Part 6, 6.7.2.2", has_id, RuleNeed::OpenChannel},
    {"channel-lifetime", "OpenSecureChannel", "A lifetime of 0 is revised", "requestedLifetime = 0",
     "a revisedLifetime above 0", "Part 4, 5.6.2.2", lifetime, RuleNeed::OpenChannel},
    {"channel-policy-unknown", "OpenSecureChannel", "An unknown policy is refused",
     "SecurityPolicyUri = urn:none.such",
     one_of(status::Bad_SecurityPolicyRejected, status::Bad_SecurityChecksFailed, hung_up), opening,
     [](Subject& subject) {
         return opened(subject, SecurityTokenRequestType::Renew, {}, "urn:none.such");
     },
     RuleNeed::OpenChannel},
    {"channel-mode-invalid", "OpenSecureChannel", "The mode Invalid is refused",
     "securityMode = Invalid", bad_mode, opening,
     [](Subject& subject) {
         return opened(subject, SecurityTokenRequestType::Renew,
                       [](OpenSecureChannelRequest& request) {
                           request.security_mode = MessageSecurityMode::Invalid;
                       });
     },
     RuleNeed::OpenChannel},
    {"channel-mode-sign", "OpenSecureChannel", "Policy None signs nothing",
     "policy None, securityMode = Sign", bad_mode, opening,
     [](Subject& subject) {
         return opened(subject, SecurityTokenRequestType::Renew,
                       [](OpenSecureChannelRequest& request) {
                           request.security_mode = MessageSecurityMode::Sign;
                       });
     },
     RuleNeed::OpenChannel},
    {"channel-issue-twice", "OpenSecureChannel", "A channel is opened once",
     "Issue on an open channel",
     one_of(status::Bad_RequestTypeInvalid, status::Bad_TcpSecureChannelUnknown,
            status::Bad_SecureChannelIdInvalid, status::Bad_SecurityChecksFailed, hung_up),
     "Part 4, 5.6.2.2",
     [](Subject& subject) { return opened(subject, SecurityTokenRequestType::Issue); },
     RuleNeed::OpenChannel},
    {"channel-renew-other", "OpenSecureChannel", "Only the connection's channel is renewed",
     "SecureChannelId = 2147483632", no_channel, errors,
     [](Subject& subject) {
         return opened(subject, SecurityTokenRequestType::Renew, {}, {}, 0x7FFF'FFF0U);
     },
     RuleNeed::OpenChannel},
    {"channel-renew-token", "OpenSecureChannel", "A renewal gives another token", "Renew",
     "another TokenId of the same channel", tokens,
     [](Subject& subject) {
         return renewed(subject, [](RawChannel& channel, const ChannelSecurityToken& old) {
             return expect(channel.token().token_id != old.token_id &&
                               channel.token().channel_id == old.channel_id,
                           "the same token, or another channel");
         });
     },
     RuleNeed::OpenChannel},
    {"channel-renew-old", "OpenSecureChannel", "The old token serves until the new one is used",
     "a request, Renew, then the old token", status::Good, tokens,
     [](Subject& subject) { return old_token(subject, true); }, RuleNeed::OpenChannel},
    {"channel-renew-unused", "OpenSecureChannel", "The old token serves even if never used before",
     "Issue, Renew, then the first token", status::Good, tokens,
     [](Subject& subject) { return old_token(subject, false); }, RuleNeed::OpenChannel},
    {"channel-renew-new", "OpenSecureChannel", "The new token serves at once",
     "Renew, then the new token", status::Good, tokens,
     [](Subject& subject) {
         return renewed(subject, [](RawChannel& channel, const ChannelSecurityToken&) {
             return with_token(channel, channel.token().token_id);
         });
     },
     RuleNeed::OpenChannel},
    {"channel-token-unknown", "Secure conversation", "An unknown token is refused",
     "TokenId = 2147483632", no_channel, errors,
     [](Subject& subject) {
         return refused(subject, "MSGF", [](RawChannel& channel) {
             return channel.message(channel.some_request(), 0, 0x7FFF'FFF0U);
         });
     },
     RuleNeed::OpenChannel},
    {"channel-unknown", "Secure conversation", "An unknown channel is refused",
     "SecureChannelId = 2147483632", no_channel, errors,
     [](Subject& subject) {
         return refused(subject, "MSGF", [](RawChannel& channel) {
             return channel.message(channel.some_request(), 0, 0, 0x7FFF'FFF0U);
         });
     },
     RuleNeed::OpenChannel},
    {"channel-sequence-repeated", "Secure conversation", "A sequence number is not used twice",
     "the last sequence number again", bad_number, "Part 6, 6.7.7",
     [](Subject& subject) {
         return refused(subject, "MSGF", [](RawChannel& channel) {
             return channel.message(channel.some_request(), channel.sequence_number());
         });
     },
     RuleNeed::OpenChannel},
    {"channel-sequence-gap", "Secure conversation", "A sequence number is not left out",
     "the last sequence number and 5", bad_number, "Part 6, 6.7.7",
     [](Subject& subject) {
         return refused(subject, "MSGF", [](RawChannel& channel) {
             return channel.message(channel.some_request(), channel.sequence_number() + 5);
         });
     },
     RuleNeed::OpenChannel},
    {"channel-sequence-server", "Secure conversation", "The server counts its chunks",
     "two requests", "consecutive sequence numbers", "Part 6, 6.7.2.4", sequence_numbers,
     RuleNeed::OpenChannel},
    {"channel-request-id", "Secure conversation", "A response has the RequestId", "a request",
     "its RequestId", "Part 6, 6.7.2.4", request_id, RuleNeed::OpenChannel},
    {"channel-type-unknown", "Secure conversation", "An unknown message type is refused", "XYZF",
     bad_type, errors,
     [](Subject& subject) {
         return refused(subject, "XYZF", [](RawChannel& channel) {
             return channel.message(channel.some_request());
         });
     },
     RuleNeed::OpenChannel},
    {"channel-chunks", "Secure conversation", "A request may have several chunks",
     "a request in two chunks", status::Good, "Part 6, 6.7.2.2", in_two_chunks,
     RuleNeed::OpenChannel},
    {"channel-abort", "Secure conversation", "A request that is given up is forgotten",
     "a chunk, an abort chunk, another request", status::Good, "Part 6, 6.7.3", aborted,
     RuleNeed::OpenChannel},
    {"channel-chunk-large", "Secure conversation", "A chunk beyond the buffer is refused",
     "a size of the receive buffer and 1", one_of(status::Bad_TcpMessageTooLarge, hung_up), errors,
     too_large, RuleNeed::OpenChannel},
    {"channel-chunk-size", "Secure conversation", "The server keeps the client's buffer",
     "buffers of 8,192 bytes", "chunks of at most 8,192 bytes", hello, chunk_sizes,
     RuleNeed::OpenChannel},
    {"channel-response-size", "Secure conversation", "The server keeps the client's message size",
     "MaxMessageSize = 60", status::Bad_ResponseTooLarge, hello, small_responses,
     RuleNeed::OpenChannel},
    {"channel-close", "CloseSecureChannel", "A channel is closed without a response", "CLO",
     "the end of the connection", "Part 6, 7.1.5", closed, RuleNeed::OpenChannel},
};

} // namespace transport
} // namespace

std::span<const SpecRule> transport_rules()
{
    return transport::rules;
}

} // namespace busbar::tool::rules
