#ifdef BRIS_MOSQUITTO

#include "engine/io/mqtt_packets.hpp"

#include "engine/printable.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace bris {

std::string final_answer(int code) {
    switch (code) {
    case MQTT_RC_SESSION_TAKEN_OVER:
        return "another client has taken the session over";
    case MQTT_RC_ADMINISTRATIVE_ACTION:
        return "an administrator of the broker has ended the connection";
    case MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION:
    case CONNACK_REFUSED_PROTOCOL_VERSION: // by brokers of older versions, as the three below
        return "the broker does not know version 5 of MQTT";
    case CONNACK_REFUSED_IDENTIFIER_REJECTED:
    case MQTT_RC_CLIENTID_NOT_VALID:
        return "the broker refuses the client's name";
    case CONNACK_REFUSED_BAD_USERNAME_PASSWORD:
    case MQTT_RC_BAD_USERNAME_OR_PASSWORD:
        return "the broker refuses the user name or the password";
    case CONNACK_REFUSED_NOT_AUTHORIZED:
    case MQTT_RC_NOT_AUTHORIZED:
        return "the broker refuses the client: not authorised";
    case MQTT_RC_BANNED:
    case MQTT_RC_BAD_AUTHENTICATION_METHOD:
    case MQTT_RC_RETAIN_NOT_SUPPORTED:
    case MQTT_RC_QOS_NOT_SUPPORTED:
    case MQTT_RC_USE_ANOTHER_SERVER:
    case MQTT_RC_SERVER_MOVED:
    case MQTT_RC_WILDCARD_SUBS_NOT_SUPPORTED:
        return fmt::format("the broker refuses the client: {}", mosquitto_reason_string(code));
    default:
        return {};
    }
}

std::string other_broker(const mosquitto_property* properties) {
    char* named = nullptr;
    if (mosquitto_property_read_string(properties, MQTT_PROP_SERVER_REFERENCE, &named, false) ==
        nullptr)
        return {};
    const std::string text = fmt::format("; it names \"{}\"", beginning_of(named));
    std::free(named);
    return text;
}

} // namespace bris

#endif
