"""Common parts of campaigns with the scenario track_passage: its sensor rocks, names of their levels in summary.json, and runs over one bed."""
import seed_campaign

SENSORS = ('rail_seat_5cm', 'rail_seat_25cm', 'middle_5cm', 'middle_25cm', 'end_5cm', 'end_25cm', 'between_5cm', 'between_25cm')
BANDS = ('1_to_5', '5_to_20', '20_to_80')  # Hz
RMS, PEAK, ENTROPY = 'vertical_rms_{}_m_per_s2', 'vertical_peak_{}_m_per_s2', 'vertical_entropy_{}'
FOLLOWING, REST = 'vertical_rms_following_load_{}_m_per_s2', 'vertical_rms_of_rest_{}_m_per_s2'
POWERS = tuple(f'vertical_power_{band}_Hz_{{}}_m2_per_s4' for band in BANDS)
ROTATIONS = ROLL, PITCH, YAW = tuple(f'{axis}_rate_rms_{{}}_rad_per_s' for axis in ('roll', 'pitch', 'yaw'))


def run(args, words, out, first):
    """Runs the scenario to the folder `out`: on from where a run there stopped, else over the bed that the run of the folder `first` has made."""
    begun, bed = out / 'track_passage.ckpt.h5', first / 'bed.ckpt.h5'
    resumed = ['--resume', begun] if begun.exists() else ['--resume', bed] if bed.exists() else []
    seed_campaign.scenario(args, 'track_passage', [*words, *resumed], out)
