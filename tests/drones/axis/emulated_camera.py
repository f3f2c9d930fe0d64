#!/usr/bin/python3
"""The emulated camera (../../support/axis_camera.py) is itself right: digests, parameters, words."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "support"))
import axis_camera  # noqa: E402

OWNER = "root", "pass"


def behaviour(**words):
    result = axis_camera.Behaviour()
    for name, value in words.items():
        result.set(name, value)
    return result


def nonce_in(challenge):
    return challenge.split('nonce="')[1].split('"')[0]


def digest(nonce, uri, owner=OWNER, qop=False):
    fields = {"nonce": nonce, "uri": uri} | ({"cnonce": "abc", "nc": "00000001", "qop": "auth"} if qop else {})
    fields["response"] = axis_camera.digest_response(owner, "AXIS_00408C", "GET", fields)
    fields |= {"username": owner[0], "realm": "AXIS_00408C"}
    return "Digest " + ", ".join(f'{name}="{value}"' for name, value in fields.items())


class LoginTest(unittest.TestCase):
    def setUp(self):
        self.login = axis_camera.Login(OWNER, "AXIS_00408C")

    def test_the_example_of_rfc_2617_section_3_5(self):
        fields = {"nonce": "dcd98b7102dd2f0e8b11d0f600bfb0c093", "uri": "/dir/index.html", "nc": "00000001",
                  "cnonce": "0a4f113b", "qop": "auth"}
        self.assertEqual(axis_camera.digest_response(("Mufasa", "Circle Of Life"), "testrealm@host.com", "GET", fields),
                         "6629fae49393a05397450978507c4ef1")

    def test_both_schemes_are_offered_either_is_accepted_wrong_ones_are_not(self):
        both = behaviour(auth="basic_digest")
        self.assertEqual(self.login.check(both, "GET", "/x", ""), "unknown")
        challenges = self.login.challenges(both, "unknown")
        self.assertEqual(len(challenges), 2)
        self.assertTrue(challenges[0].startswith('Digest realm="AXIS_00408C", nonce="'))
        self.assertEqual(challenges[1], 'Basic realm="AXIS_00408C"')
        nonce = nonce_in(challenges[0])
        for qop in True, False:
            for method, uri, text, verdict in (
                    ("GET", "/x?y=1", digest(nonce, "/x?y=1", qop=qop), "welcome"),
                    ("GET", "/other", digest(nonce, "/x", qop=qop), "wrong"),
                    ("POST", "/x", digest(nonce, "/x", qop=qop), "wrong"),
                    ("GET", "/x", digest(nonce, "/x", ("root", "wrong"), qop), "wrong")):
                self.assertEqual(self.login.check(both, method, uri, text), verdict)
        self.assertEqual(self.login.check(both, "GET", "/x", "Basic cm9vdDpwYXNz"), "welcome")
        self.assertEqual(self.login.check(both, "GET", "/x", "Basic cm9vdDpwYXN0"), "wrong")
        self.assertEqual(self.login.check(behaviour(auth="digest"), "GET", "/x", "Basic cm9vdDpwYXNz"), "unknown")
        self.assertEqual(self.login.check(behaviour(), "GET", "/x", ""), "welcome")

    def test_a_nonce_that_was_used_up_is_stale_and_the_next_challenge_has_a_new_one(self):
        twice = behaviour(auth="digest", nonce_uses="2")
        nonce = nonce_in(self.login.challenges(twice, "unknown")[0])
        for verdict in "welcome", "welcome", "stale":
            self.assertEqual(self.login.check(twice, "GET", "/", digest(nonce, "/")), verdict)
        challenge = self.login.challenges(behaviour(auth="digest", qop="off"), "stale")[0]
        self.assertTrue(challenge.endswith("stale=TRUE"))
        self.assertNotEqual(nonce_in(challenge), nonce)
        self.assertEqual(self.login.check(twice, "GET", "/", digest(nonce, "/")), "stale")
        self.assertEqual(self.login.check(twice, "GET", "/", digest(nonce_in(challenge), "/")), "welcome")


class ParametersTest(unittest.TestCase):
    def setUp(self):
        self.parameters = axis_camera.Parameters()

    def test_groups_are_listed_and_unknown_ones_are_an_error_among_the_others(self):
        lines = self.parameters.list("root.Brand,Nowhere,ImageSource.I0.Sensor.Brightness").split("\r\n")
        self.assertIn("root.Brand.Brand=AXIS", lines)
        self.assertIn("root.ImageSource.I0.Sensor.Brightness=50", lines)
        self.assertEqual([line for line in lines if line.startswith("#")],
                         ["# Error: Error -1 getting param in group 'Nowhere'"])
        self.assertGreater(self.parameters.list("").count("root."), 10)
        self.assertNotIn("root.", self.parameters.list("Bran"))

    def test_an_update_sets_what_it_can_and_names_what_it_cannot(self):
        values = self.parameters.values
        self.assertEqual(self.parameters.update([("root.ImageSource.I0.Sensor.Brightness", "63")], 1), "OK\r\n")
        self.assertEqual(values["ImageSource.I0.Sensor.Brightness"], "63")
        refused = self.parameters.update([("Image.I0.Appearance.Resolution", "9x9"), ("Image.I0.Appearance.Compression", "10"),
                                          ("Brand.Brand", "x"), ("No", "1")], 1)
        self.assertEqual(refused.count("# Error"), 3)
        self.assertTrue(refused.startswith("# Error: Error setting 'root.Image.I0.Appearance.Resolution' to '9x9'!"))
        self.assertEqual(values["Image.I0.Appearance.Compression"], "10")
        self.assertEqual(self.parameters.update([("ImageSource.I0.Sensor.Brightness", "58")], 5), "OK\r\n")
        self.assertEqual(values["ImageSource.I0.Sensor.Brightness"], "55")


class BehaviourTest(unittest.TestCase):
    def test_words_are_set_by_name_and_a_wrong_one_is_answered_with_the_valid_ones(self):
        words = behaviour(close_after="7", mute="on", auth="digest")
        self.assertEqual((words["close_after"], words["mute"], words["auth"]), (7, True, "digest"))
        self.assertIn("\nclose_after=7\n", str(words))
        for name, value, problem in (("stal", "1", "stall"), ("close_after", "soon", "number"), ("mute", "yes", "off on"),
                                     ("auth", "ntlm", "basic_digest")):
            with self.assertRaisesRegex(ValueError, problem):
                words.set(name, value)

    def test_the_help_names_every_word(self):
        for word in axis_camera.WORDS:
            self.assertRegex(axis_camera.__doc__, rf"\b{word}=")


if __name__ == "__main__":
    unittest.main()
